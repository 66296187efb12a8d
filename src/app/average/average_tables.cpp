// Numbers to cells.
#include "app/average/average_tables.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/text/number.hpp"

namespace sysid {
namespace {

std::string number_cell(double value) {
  if (std::isinf(value)) return value < 0 ? "-infinity" : "infinity";
  return std::isnan(value) ? "-" : significant(value, 4);
}
std::string percent_cell(double share) { return std::isnan(share) ? "-" : fmt::format("{:.1f}", 100 * share); }

std::vector<std::string> scores_row(std::string name, std::string weight, AverageScores const& scores) {
  return {std::move(name),          std::move(weight),        number_cell(scores.log_score),
          number_cell(scores.nmse), number_cell(scores.rmse), number_cell(scores.coverage_95)};
}

std::string name_of(AveragedMember const& member) {
  return member.model.empty() ? member.fit : fmt::format("{} ({})", member.fit, member.model);
}

std::string weight_of(AveragedMember const& member) {
  if (!member.counted.empty()) return "with " + member.counted;
  return significant(member.weight, 3) + (member.error ? fmt::format(" ({})", significant(*member.error, 1)) : std::string());
}

std::string log_score_caption(AveragedChannel const& channel) {
  std::string caption = "log score: mean over the samples of the log predictive density [nats], higher is better";
  bool impossible = std::isinf(channel.average.log_score);
  for (AverageScores const& each : channel.members) impossible = impossible || std::isinf(each.log_score);
  if (impossible) caption += "\n-infinity: the density of some sample is zero under all draws";
  return caption;
}

}  // namespace

void add_average_tables(AverageReport const& average, std::vector<std::string> const& notes, std::vector<ReportTable>& tables) {
  for (AveragedChannel const& channel : average.channels) {
    std::string const unit = channel.unit.empty() ? "" : fmt::format(" [{}]", channel.unit);
    ReportTable table{
        fmt::format("Average and its members: {} on {}, {} samples", channel.channel, channel.experiment, channel.samples),
        log_score_caption(channel),
        {"fit", "weight", "log score", "NMSE [%]", "RMSE" + unit, "coverage_95"},
        {scores_row("average", "", channel.average)}};
    for (std::size_t k = 0; k < average.members.size(); ++k)
      table.rows.push_back(scores_row(name_of(average.members[k]), weight_of(average.members[k]), channel.members[k]));
    if (&channel == &average.channels.front())
      for (std::string const& note : notes) table.caption += "\n" + note;
    tables.push_back(std::move(table));
  }
  if (average.channels.empty()) {
    ReportTable table{"Members of the average", "", {"fit", "weight"}, {}};
    for (AveragedMember const& member : average.members) table.rows.push_back({name_of(member), weight_of(member)});
    tables.push_back(std::move(table));
  }
  if (average.shares.empty()) return;
  ReportTable table{"Where the variance comes from",
                    "averages over the record; sd: root of the average variance, with the noise of channels",
                    {"quantity", "sd", "parameter [%]", "model [%]", "noise [%]"},
                    {}};
  bool several = false, without = false;
  for (VarianceShares const& each : average.shares) without = without || std::isnan(each.sd);
  if (without) table.caption += "\n-: the noise has no finite variance at some of the draws";
  for (VarianceShares const& each : average.shares) several = several || each.experiment != average.shares.front().experiment;
  for (VarianceShares const& each : average.shares)
    table.rows.push_back({each.quantity + (several ? " on " + each.experiment : ""),
                          number_cell(each.sd) + (each.unit.empty() || std::isnan(each.sd) ? "" : " " + each.unit),
                          percent_cell(each.parameter), percent_cell(each.model), percent_cell(each.noise)});
  tables.push_back(std::move(table));
}

}  // namespace sysid
