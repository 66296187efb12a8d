// Structures and coefficients in columns.
#include "report/file/simulation_validation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/text/number.hpp"
#include "report/file/csv.hpp"
#include "report/file/discovery.hpp"
#include "report/file/number_or_null.hpp"
#include "report/text/summary_text.hpp"
#include "result/report.hpp"

namespace sysid {
namespace {

using Json = nlohmann::ordered_json;

/// Errors of more sds than this are not worth their digits.
constexpr int lost_sds = 100;

std::string percent_text(std::optional<double> percent) {
  if (!percent) return "";
  return *percent > 1e4 ? "> 1e4" : significant(*percent, 3);
}

std::string seconds(double value) { return significant(value, 3) + " s"; }

/// On channels whose noise is not alike in all samples.
std::string growth_text(ValidationReport const& validation) {
  std::string text;
  if (validation.structures.empty()) return text;
  for (ValidatedChannel const& each : validation.structures.front().channels)
    if (each.growth > 0)
      text += fmt::format(" The noise of `{0}` grows with the signal: its sd is in proportion to sqrt({0}^2 + {1}^2).",
                          each.channel, significant(each.growth, 2));
  return text;
}

ReportTable structure_table(ValidationReport const& validation) {
  std::string const segments =
      validation.segments == 1
          ? fmt::format("one run of {}", seconds(validation.longest))
          : fmt::format("{} runs of {}, each with its own start", validation.segments,
                        validation.longest - validation.shortest > validation.step
                            ? fmt::format("{} to {}", seconds(validation.shortest), seconds(validation.longest))
                            : seconds(validation.longest));
  ReportTable table{
      fmt::format("structures by simulation: {}", segments),
      "Log odds of a structure relative to the first: log evidence plus log prior, which depends on the number of terms. Draws "
      "bounded: number of draws of the coefficients with which a free run stays within ten times the range of the measurements.",
      {"terms", "log odds", "probability", "residual/noise"},
      {}};
  bool const scored = !validation.held_out.empty();
  if (scored) {
    table.caption += fmt::format(
        " Errors: root mean square in percent of the sd, for the worst channel, on {}{}; {} rows are {}; each start is estimated "
        "from the {} rows before it.",
        validation.held_out,
        validation.held_out_seen ? " (used to choose the terms, but not to estimate the coefficients that are scored here)" : "",
        validation.horizon_rows, seconds(validation.horizon), validation.window_rows);
    table.header.insert(table.header.end(), {"1 row ahead %", fmt::format("{} rows %", validation.horizon_rows), "free run %"});
  }
  table.header.push_back("draws bounded");
  table.caption += growth_text(validation);
  auto const weight = [](ValidatedStructure const& each) { return each.log_evidence + each.log_prior; };
  double const best = validation.structures.empty() ? 0 : weight(validation.structures.front());
  for (ValidatedStructure const& each : validation.structures) {
    if (!each.failure.empty()) continue;
    std::vector<std::string> row = {each.terms};
    row.insert(row.end(), {significant(weight(each) - best, 4), probability_text(each.probability),
                           each.residual_over_noise > 0 ? significant(each.residual_over_noise, 3) : ""});
    if (scored)
      for (auto const error : {&ValidatedChannel::one_step, &ValidatedChannel::horizon, &ValidatedChannel::free_run})
        row.push_back(percent_text(each.percent(error)));
    row.push_back(each.draws > 0 ? fmt::format("{} of {}", each.bounded, each.draws) : "");
    table.rows.push_back(std::move(row));
  }
  return table;
}

ReportTable failure_table(ValidationReport const& validation) {
  ReportTable table{"structures that could not be checked by simulation", "", {"terms", "why"}, {}};
  for (ValidatedStructure const& each : validation.structures)
    if (!each.failure.empty()) table.rows.push_back({each.terms, each.failure});
  return table;
}

ReportTable coefficient_table(ValidatedStructure const& best) {
  bool const several = best.equations.size() > 1;
  ReportTable table{"coefficients by simulation",
                    "Compared with those of the regression on the same terms.",
                    {"term", "coefficient", "sd", "regression", "sd", "unit"},
                    {}};
  if (several) table.header.insert(table.header.begin(), "equation");
  for (ValidatedCoefficient const& each : best.coefficients) {
    auto const [value, sd] = coefficient_text(each.value, each.sd);
    bool const listed = std::isfinite(each.regression);
    auto const [before, before_sd] =
        listed ? coefficient_text(each.regression, each.regression_sd) : std::pair(std::string("-"), std::string("-"));
    std::vector<std::string> row = {each.term, value, sd, before, before_sd, each.unit};
    if (several) row.insert(row.begin(), each.target);
    table.rows.push_back(std::move(row));
  }
  return table;
}

ReportTable channel_table(ValidationReport const& validation, ValidatedStructure const& best) {
  ReportTable table{
      fmt::format("errors of the first structure on {}", validation.held_out),
      "Root mean square, in the channel's unit; the residual is that of the refit.",
      {"channel", "unit", "sd", "noise", "residual", "1 row ahead", fmt::format("{} rows", validation.horizon_rows), "free run"},
      {}};
  for (ValidatedChannel const& each : best.channels) {
    auto const shown = [&](std::optional<double> value) {
      if (value && each.sd > 0 && !(*value <= lost_sds * each.sd)) return fmt::format("> {} sd", lost_sds);
      return value ? significant(*value, 3) : std::string();
    };
    table.rows.push_back({each.channel, each.unit, significant(each.sd, 3), each.noise > 0 ? significant(each.noise, 3) : "",
                          significant(each.residual, 3), shown(each.one_step), shown(each.horizon), shown(each.free_run)});
  }
  return table;
}

Json structure_json(ValidatedStructure const& each) {
  Json structure = {{"terms", each.terms}, {"rank_by_regression", each.of_regression}};
  if (!each.failure.empty()) {
    structure["failure"] = each.failure;
    return structure;
  }
  Json coefficients = Json::array(), channels = Json::array();
  for (ValidatedCoefficient const& one : each.coefficients)
    coefficients.push_back({{"target", one.target},
                            {"term", one.term},
                            {"name", one.name},
                            {"unit", one.unit},
                            {"value", one.value},
                            {"sd", number_or_null(one.sd)},
                            {"regression", number_or_null(one.regression)},
                            {"regression_sd", number_or_null(one.regression_sd)},
                            {"inside_terms", one.inside}});
  for (ValidatedChannel const& one : each.channels)
    channels.push_back({{"channel", one.channel},
                        {"unit", one.unit},
                        {"sd", one.sd},
                        {"residual", one.residual},
                        {"noise", one.noise},
                        {"noise_grows_beyond", one.growth > 0 ? Json(one.growth) : Json()},
                        {"one_step", number_or_null(one.one_step)},
                        {"horizon", number_or_null(one.horizon)},
                        {"free_run", number_or_null(one.free_run)}});
  structure.update({{"equations", each.equations},
                    {"log_evidence", each.log_evidence},
                    {"log_prior", each.log_prior},
                    {"probability", each.probability},
                    {"residual_over_noise", each.residual_over_noise},
                    {"draws", each.draws},
                    {"draws_bounded", each.bounded},
                    {"follows_for", each.follows},
                    {"coefficients", std::move(coefficients)},
                    {"channels", std::move(channels)}});
  return structure;
}

}  // namespace

std::vector<ReportTable> validation_tables(ValidationReport const& validation) {
  bool const any = !validation.structures.empty() && validation.structures.front().failure.empty();
  std::vector<ReportTable> tables;
  if (any) tables.push_back(structure_table(validation));
  if (ReportTable failed = failure_table(validation); !failed.rows.empty()) tables.push_back(std::move(failed));
  if (!any) return tables;
  ValidatedStructure const& best = validation.structures.front();
  tables.push_back(coefficient_table(best));
  if (!validation.held_out.empty()) tables.push_back(channel_table(validation, best));
  return tables;
}

nlohmann::ordered_json validation_json(ValidationReport const& validation) {
  Json out = {{"segments", validation.segments},
              {"shortest_segment", validation.shortest},
              {"longest_segment", validation.longest},
              {"whole", validation.whole},
              {"solver", validation.solver},
              {"kept_aside", validation.held_out},
              {"kept_aside_seen_by_choice", validation.held_out_seen},
              {"horizon", validation.horizon},
              {"horizon_rows", validation.horizon_rows},
              {"start_rows", validation.window_rows},
              {"structures", Json::array()}};
  for (ValidatedStructure const& each : validation.structures) out["structures"].push_back(structure_json(each));
  if (auto const& outside = validation.outside)
    out["other_terms"] = {{"equation", outside->text},
                          {"log_odds", outside->log_odds},
                          {"log_likelihood", outside->log_likelihood},
                          {"coefficients", outside->coefficients},
                          {"criterion", outside->criterion()}};
  return out;
}

std::vector<std::pair<std::string, std::string>> validation_files(Report const& report, ValidationReport const& validation) {
  std::string structures =
      csv_head(report) +
      "rank,rank_by_regression,terms,failure,log_evidence,log_prior,probability,residual_over_noise,one_step_percent,"
      "horizon_percent,free_run_percent,follows_for,draws,draws_bounded\n";
  std::string refit = csv_head(report) + "rank,equation,term,name,unit,coefficient,sd,regression,regression_sd\n";
  int rank = 0;
  for (ValidatedStructure const& each : validation.structures) {
    auto const percent = [&](auto error) {
      auto const value = each.percent(error);
      return value ? shortest(*value) : std::string();
    };
    ++rank;
    structures +=
        each.failure.empty()
            ? fmt::format("{},{},{},,{},{},{},{},{},{},{},{},{},{}\n", rank, each.of_regression, csv_field(each.terms),
                          shortest(each.log_evidence), shortest(each.log_prior), shortest(each.probability),
                          shortest(each.residual_over_noise), percent(&ValidatedChannel::one_step),
                          percent(&ValidatedChannel::horizon), percent(&ValidatedChannel::free_run), shortest(each.follows),
                          each.draws, each.bounded)
            : fmt::format("{},{},{},{},,,,,,,,,,\n", rank, each.of_regression, csv_field(each.terms), csv_field(each.failure));
    for (ValidatedCoefficient const& one : each.coefficients)
      refit += fmt::format("{},{},{},{},{},{},{},{},{}\n", rank, csv_field(one.target), csv_field(one.term), csv_field(one.name),
                           csv_field(one.unit), shortest(one.value), shortest(one.sd), shortest(one.regression),
                           shortest(one.regression_sd));
  }
  return {{"structures.csv", std::move(structures)}, {"refit.csv", std::move(refit)}};
}

}  // namespace sysid
