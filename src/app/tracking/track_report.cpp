// Of an endless record the page shows some hundred rows, ever farther apart.
#include "app/tracking/track_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/session/made_from.hpp"
#include "app/session/repetition.hpp"
#include "app/session/reporting.hpp"
#include "app/tracking/track_findings.hpp"
#include "core/text/number.hpp"
#include "model/filter_rule.hpp"

namespace sysid {
namespace {

constexpr std::size_t most_kept_outliers = 100, most_kept_restarts = 100;
constexpr std::size_t most_shown = 300;  // and up to twice as many: all that a figure shows

std::vector<std::string> channel_names(Model const& model) {
  std::vector<std::string> names;
  for (Channel const& channel : model.channels) names.push_back(channel.name);
  return names;
}

}  // namespace

std::string with_sd(double value, double sd) {
  if (!(sd > 0) || !std::isfinite(value)) return significant(value, 4);
  // Of the smallest sds the ratio is infinite.
  int const digits = value == 0 ? 2 : static_cast<int>(std::clamp(std::floor(std::log10(std::fabs(value) / sd)) + 3, 2.0, 9.0));
  return fmt::format("{} ± {}", significant(value, digits), significant(sd, 2));
}

namespace {

ReportTable alarm_table(GatheredTrack const& gathered, double rate) {
  ReportTable table{
      "changes",
      fmt::format("Changes of parameters found from the innovations: |z| above {:.2f}, by the union bound at most {:g} false "
                  "alarms per row. After row: the last row before the change. Values with their sds. Alternative: a parameter "
                  "whose change would explain the innovations about as well.",
                  gathered.threshold, rate),
      {"parameter", "after row", "before", "now", "found at row", "t [s]", "z", "alternative"},
      {}};
  for (Alarm const& each : gathered.alarms) {
    std::size_t const q = gathered.states + static_cast<std::size_t>(each.parameter);
    double const scale = gathered.units.scales[q];
    table.rows.push_back(
        {gathered.name(q), std::to_string(each.onset_row), with_sd(each.before / scale, each.before_sd / scale),
         with_sd(each.after / scale, each.after_sd / scale), std::to_string(each.row), significant(each.time, 7),
         fmt::format("{:.1f}", each.statistic),
         each.other < 0 || std::fabs(each.other_statistic) < std::fabs(each.statistic) - 2
             ? std::string()
             : fmt::format("{} (z = {:.1f})", gathered.units.names[gathered.states + static_cast<std::size_t>(each.other)],
                           each.other_statistic)});
  }
  return table;
}

ReportTable parameter_table(GatheredTrack const& gathered) {
  ReportTable table{"parameters",
                    gathered.settled ? "Values with their sds. The first rows serve to estimate the states; after them the "
                                       "parameters are reset to their values in the fit."
                                     : "Values with their sds.",
                    {"parameter", fmt::format("row {}", gathered.last_row),
                     gathered.settled ? "from the fit" : fmt::format("row {}", gathered.first_row)},
                    {}};
  for (std::size_t q = gathered.states; q < gathered.states + gathered.tracked; ++q)
    table.rows.push_back({gathered.name(q), with_sd(gathered.last_mean[q], gathered.last_sd[q]),
                          with_sd(gathered.first_mean[q], gathered.first_sd[q])});
  return table;
}

ReportTable innovation_table(GatheredTrack const& gathered) {
  InnovationSize const size = innovation_size(gathered);
  return {"innovations",
          "Their rms divided by the expected rms, 1 where the model and its noise are right. Where it differs from 1 by more than "
          "a tenth, sds and the rate of false alarms are not as stated: a disturbance is missing, or the noise has changed.",
          {"samples", "rms / expected", "z", ""},
          {{std::to_string(gathered.samples), significant(size.ratio, 4), fmt::format("{:.1f}", size.z),
            !size.odd()      ? "as expected"
            : size.ratio > 1 ? "larger than expected"
                             : "smaller than expected"}}};
}

}  // namespace

GatheredTrack::GatheredTrack(TrackedFit const& fit, TrackedUnits of)
    : units(std::move(of)),
      channels(channel_names(fit.model())),
      states(fit.model().states.size()),
      tracked(fit.tracked.size()),
      disturbed(!fit.model().disturbances.empty()),
      usual_step(fit.tracking.usual_step),
      mean(units.names.size()),
      sd(mean) {}

void GatheredTrack::add(TrackedRow const& row) {
  auto const declared = [&](std::vector<double> values) {
    for (std::size_t q = 0; q < values.size(); ++q) values[q] /= units.scales[q];
    return values;
  };
  if (rows == 0) first_row = row.row;
  settled = settled || (rows == 0 && row.settling);  // a filter that begins again later settles its states, too
  if (rows == 0 || (settled && row.settling && !past_settling)) first_mean = declared(row.mean), first_sd = declared(row.sd);
  // What is reset behind the settling rows would look like a change in the figures.
  if (settled && !row.settling && !past_settling) {
    past_settling = true;
    kept = 0, stride = 1;
    time.clear();
    for (std::size_t q = 0; q < mean.size(); ++q) mean[q].clear(), sd[q].clear();
  }
  ++rows;
  last_row = row.row;
  if (!row.settling) squared += row.squared, samples += row.samples;
  if (row.alarm != nullptr) alarms.push_back(*row.alarm);
  if (row.noise != nullptr) noises.push_back(*row.noise);
  if (row.restart != nullptr) {
    bool const gap = row.restart->cause == Restart::Cause::gap;
    ++(gap ? all_gaps : all_restarts);
    if (auto& kept_ones = gap ? gaps : restarts; kept_ones.size() < most_kept_restarts) kept_ones.push_back(*row.restart);
  }
  for (std::size_t c = 0; c < row.left_out.size(); ++c) {
    if (row.left_out[c] == 0) continue;
    ++left_out_samples;
    if (left_out.size() < most_kept_outliers) left_out.push_back({row.row, channels[c], row.left_out[c]});
  }
  if (kept++ % stride == 0) {
    time.push_back(row.time);
    for (std::size_t q = 0; q < mean.size(); ++q) {
      mean[q].push_back(row.mean[q] / units.scales[q]);
      sd[q].push_back(row.sd[q] / units.scales[q]);
    }
    if (time.size() == 2 * most_shown) {
      auto const halve = [](std::vector<double>& values) {
        for (std::size_t i = 0; i < most_shown; ++i) values[i] = values[2 * i];
        values.resize(most_shown);
      };
      halve(time);
      for (std::size_t q = 0; q < mean.size(); ++q) halve(mean[q]), halve(sd[q]);
      stride *= 2;
    }
  }
  last_mean.resize(mean.size());
  last_sd.resize(mean.size());
  for (std::size_t q = 0; q < mean.size(); ++q) {
    last_mean[q] = row.mean[q] / units.scales[q];
    last_sd[q] = row.sd[q] / units.scales[q];
  }
}

std::string GatheredTrack::alarm_line(Alarm const& alarm) const {
  return fmt::format("row {} (t = {} s): {} (z = {:.1f})", alarm.row, significant(alarm.time, 7), change_words(*this, alarm),
                     alarm.statistic);
}

std::vector<std::string> GatheredTrack::lines(TrackedRow const& row) const {
  std::vector<std::string> all;
  auto const head = [&] { return fmt::format("row {} (t = {} s): ", row.row, significant(row.time, 7)); };
  if (row.restart != nullptr) all.push_back(head() + restart_words(*row.restart));
  if (row.alarm != nullptr) all.push_back(alarm_line(*row.alarm));
  if (row.noise != nullptr) all.push_back(head() + noise_words(*this, *row.noise));
  return all;
}

bool GatheredTrack::changed() const { return !alarms.empty() || !noises.empty() || all_restarts > 0; }

std::string GatheredTrack::name(std::size_t quantity) const {
  std::string const& unit = units.units[quantity];
  return units.names[quantity] + (unit.empty() || unit == "-" ? "" : fmt::format(" [{}]", unit));
}

namespace {

/// All options that change the table.
std::string repetition_of(Session const& session, TrackOptions const& options) {
  TrackOptions const usual;
  std::string command =
      fmt::format("sysid track {} {}", quoted_for_shell(session.source.name()), quoted_for_shell(options.result.string()));
  if (!options.data.empty()) command += " --data " + options.data;
  if (!options.record.empty())
    command += " --record " + (options.record == "-" ? options.record : quoted_for_shell(options.record));
  if (options.first_row > 1 || options.last_row > 0)
    command += fmt::format(" --rows {}..{}", options.first_row, options.last_row > 0 ? std::to_string(options.last_row) : "");
  if (options.at_rest) command += " --at-rest";
  if (!options.parameters.empty())
    command += " --parameters " + quoted_for_shell(fmt::format("{}", fmt::join(options.parameters, ",")));
  if (!options.drift.text.empty() && options.drift.text != shortest(usual.drift.relative))
    command += " --drift " + options.drift.text;
  if (options.filter != usual.filter) command += fmt::format(" --filter {}", filter_name(options.filter));
  if (options.false_alarms != usual.false_alarms) command += " --false-alarms " + shortest(options.false_alarms);
  if (options.window != usual.window) command += fmt::format(" --window {}", options.window);
  return command + " -o " + folder_of_repetition(session.options);
}

}  // namespace

Report track_head(Session const& session, TrackedFit const& fit) {
  TrackOptions const& options = fit.options;
  Report report = begin_report(session, *fit.task, fit.fit->model,
                               fmt::format("track the parameters of {} along {}", fit.task->name,
                                           options.record.empty()  ? fit.block(session).name
                                           : options.record == "-" ? "standard input"
                                                                   : options.record),
                               0);
  report.verb = "track";
  report.command = repetition_of(session, options);
  std::vector<std::string> names;
  for (TrackedParameter const& each : fit.tracked)
    names.push_back(fit.model().parameters[static_cast<std::size_t>(each.parameter)].name);
  report.settings = {{"parameters", fmt::format("{}", fmt::join(names, ", "))},
                     {"fixed", fmt::format("{}", fmt::join(fit.fixed, ", "))},
                     {"drift", options.drift.time > 0 ? fmt::format("{} in {} s", options.drift.relative, options.drift.time)
                                                      : fmt::format("{} in 1000 rows", options.drift.relative)},
                     {"filter", std::string(filter_name(options.filter))},
                     {"false_alarms", options.false_alarms},
                     {"window", static_cast<std::int64_t>(options.window)}};
  if (fit.model().integrated()) report.settings.emplace_back("solver", fit.solver.text());
  return report;
}

void fill_report(Session const& session, TrackedFit const& fit, GatheredTrack const& gathered, Report& report) {
  add_source(fit.options.result, report);
  DataInfo data;
  data.name = fit.block(session).name;
  data.file = gathered.file;
  data.sha256 = gathered.digest;
  data.rows = gathered.last_row;
  data.scored = gathered.rows;
  data.scored_rows = fmt::format("{}..{}", gathered.first_row, gathered.last_row);
  report.data.push_back(data);
  Prediction along;
  along.experiment = fit.block(session).name;
  along.time = gathered.time;
  if (gathered.time_unit) along.time_unit = gathered.time_unit->text, along.time_scale = gathered.time_unit->scale;
  along.scored.assign(along.time.size(), 1);
  // States move too fast for rows so far apart.
  for (std::size_t q = gathered.states; q < gathered.mean.size(); ++q) {
    PredictedQuantity quantity{gathered.units.names[q], gathered.units.units[q], {}, {}, {}, {}};
    quantity.response.mean = gathered.mean[q];
    quantity.response.sd = gathered.sd[q];
    for (std::size_t i = 0; i < along.time.size(); ++i) {
      quantity.response.lower.push_back(gathered.mean[q][i] - 1.96 * gathered.sd[q][i]);
      quantity.response.upper.push_back(gathered.mean[q][i] + 1.96 * gathered.sd[q][i]);
    }
    for (Alarm const& each : gathered.alarms)
      if (gathered.states + static_cast<std::size_t>(each.parameter) == q) quantity.alarms.push_back(each.time);
    along.quantities.push_back(std::move(quantity));
  }
  report.predictions.push_back(std::move(along));
  report.tables.push_back(parameter_table(gathered));
  if (!gathered.alarms.empty()) report.tables.push_back(alarm_table(gathered, fit.options.false_alarms));
  report.tables.push_back(innovation_table(gathered));
  add_findings(gathered, report);
}

}  // namespace sysid
