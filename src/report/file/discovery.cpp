// Equations, terms and supports in columns.
#include "report/file/discovery.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/text/number.hpp"
#include "report/file/csv.hpp"
#include "report/file/number_or_null.hpp"
#include "report/file/simulation_validation.hpp"
#include "report/text/summary_text.hpp"
#include "result/report.hpp"

namespace sysid {
namespace {

using Json = nlohmann::ordered_json;

std::string sampled_text(double probability, double error) {
  return error > 0 ? fmt::format("{} ± {:.1g}", probability_text(probability), error) : probability_text(probability);
}

ReportTable term_table(DiscoveryReport const& discovery, DiscoveredEquation const& equation) {
  std::string title = fmt::format("terms of {}: {} {}", equation.target, equation.rows, discovery.windows ? "windows" : "samples");
  if (equation.noise_ratio > 0) title += fmt::format(", residual {} times the noise", significant(equation.noise_ratio, 3));
  if (equation.own_noise > 0)
    title += fmt::format(", error of the equation itself {}{} (sd at a sample)", significant(equation.own_noise, 3),
                         unit_after_number(equation.unit));
  if (!equation.moving_average.empty()) {
    std::vector<std::string> numbers;
    for (double const each : equation.moving_average) numbers.push_back(significant(each, 2));
    title += fmt::format(", a moving average with {}", fmt::join(numbers, ", "));
  }
  ReportTable table{
      std::move(title),
      "Contribution: root mean square of coefficient times term, divided by that of the explained signal; in the weak "
      "form both are weighted integrals.",
      {"term", "", "coefficient", "sd", "unit", discovery.measure, "contribution"},
      {}};
  if (discovery.validation)
    table.caption +=
        " The coefficients are those of the regression; the equation at the top has those of the fit by simulation, whose "
        "table stands below.";
  if (discovery.measure == "contribution") table.header.pop_back();
  for (DiscoveredTerm const& term : equation.terms) {
    auto const [value, sd] = coefficient_text(term.coefficient, term.sd);
    bool const offered = term.fate.kind != TermFate::Kind::left_out;
    // Of the target it is known that it is there, not how large its coefficient is.
    table.rows.push_back({term.text, term.fate.kind == TermFate::Kind::known ? "always kept" : word(term.fate),
                          term.kept ? value : "", term.kept ? sd : "", term.unit,
                          offered ? sampled_text(term.measure, term.measure_error) : ""});
    if (discovery.measure != "contribution") table.rows.back().push_back(term.kept ? significant(term.contribution, 3) : "");
  }
  return table;
}

ReportTable support_table(DiscoveredEquation const& equation) {
  bool const probable = std::any_of(equation.supports.begin(), equation.supports.end(),
                                    [](DiscoveredSupport const& each) { return each.probability > 0 && each.probability < 1; });
  ReportTable table{"best sets of terms for " + equation.target,
                    "Log evidence: relative to the equation with only the terms that are always kept; the same prior is used for "
                    "every set of terms.",
                    {"terms", "log evidence"},
                    {}};
  if (probable) table.header.insert(table.header.begin() + 1, "probability");
  for (DiscoveredSupport const& support : equation.supports) {
    table.rows.push_back(
        {support.terms.empty() ? "none" : fmt::format("{}", fmt::join(support.terms, ", ")), significant(support.log_evidence, 5)});
    if (probable)
      table.rows.back().insert(table.rows.back().begin() + 1, sampled_text(support.probability, support.probability_error));
  }
  return table;
}

}  // namespace

std::vector<ReportTable> discovery_tables(DiscoveryReport const& discovery) {
  std::vector<ReportTable> tables;
  if (!discovery.noise.empty()) {
    ReportTable noise{"measurement noise", "As used by the regression.", {"channel", "unit", "sd", ""}, {}};
    for (DiscoveryReport::Noise const& each : discovery.noise)
      noise.rows.push_back(
          {each.channel, each.unit, each.sd > 0 ? significant(each.sd, 3) : "none", each.given ? "given" : "estimated"});
    tables.push_back(std::move(noise));
  }
  if (!discovery.inner.empty()) {
    ReportTable inner{
        "parameters inside terms",
        discovery.validation
            ? "The values with which the regression explains the record best; its coefficients and sds are conditional on them. "
              "In the fit by simulation all parameters are free."
        : discovery.inner.front().sd
            ? "The values with which the regression explains the record best, with sds by Laplace's method. They count in the sds "
              "of the coefficients."
            : "The values with which the regression explains the record best. The coefficients and their sds are conditional "
              "on them.",
        {"parameter", "value", "unit", "prior"},
        {}};
    bool const with_sds = discovery.inner.front().sd.has_value();
    if (with_sds) inner.header.insert(inner.header.begin() + 2, "sd");
    for (DiscoveryReport::Inner const& each : discovery.inner) {
      if (!with_sds) {
        inner.rows.push_back({each.name, significant(each.value, 4), each.unit, each.prior});
        continue;
      }
      auto const [value, sd] = coefficient_text(each.value, *each.sd);
      inner.rows.push_back({each.name, value, sd, each.unit, each.prior});
    }
    tables.push_back(std::move(inner));
  }
  for (DiscoveredEquation const& equation : discovery.equations) {
    if (equation.equation.empty()) continue;
    tables.push_back(term_table(discovery, equation));
    if (equation.supports.size() > 1) tables.push_back(support_table(equation));
  }
  if (!discovery.excluded.empty()) {
    ReportTable excluded{
        "excluded terms", "Terms that were left out of the dictionary before the record was used.", {"term", "reason"}, {}};
    for (DiscoveryReport::Excluded const& each : discovery.excluded) excluded.rows.push_back({each.term, each.reason});
    tables.push_back(std::move(excluded));
  }
  if (!discovery.forecasts.empty()) {
    ReportTable forecast{
        "errors of predictions on " + discovery.forecast_rows,
        "Root mean squares. Expected: the free-run error that follows from the errors of the equation and of its coefficients.",
        {"target", "unit", "sd of the samples", "one sample ahead", "free run", "expected"},
        {}};
    auto const text = [](std::optional<double> const& error) {
      return !error ? std::string() : std::isfinite(*error) ? significant(*error, 3) : std::string("not finite");
    };
    for (DifferenceForecast const& each : discovery.forecasts)
      forecast.rows.push_back(
          {each.target, each.unit, significant(each.sd, 3), text(each.one_step), text(each.free_run), text(each.expected)});
    tables.push_back(std::move(forecast));
  }
  if (discovery.validation)
    for (ReportTable& table : validation_tables(*discovery.validation)) tables.push_back(std::move(table));
  return tables;
}

nlohmann::ordered_json discovery_json(DiscoveryReport const& discovery) {
  Json out = {{"selector", discovery.selector}, {"derivatives", discovery.derivatives},
              {"measure", discovery.measure},   {"half_width", discovery.half_width},
              {"noise", Json::object()},        {"equations", Json::array()},
              {"left_out", Json::array()}};
  for (DiscoveryReport::Noise const& noise : discovery.noise)
    out["noise"][noise.channel] = {{"unit", noise.unit}, {"sd", noise.sd}, {"given", noise.given}};
  for (DiscoveryReport::Inner const& each : discovery.inner)
    out["inside_terms"].push_back({{"name", each.name},
                                   {"unit", each.unit},
                                   {"prior", each.prior},
                                   {"regression", each.value},
                                   {"regression_sd", each.sd ? Json(*each.sd) : Json(nullptr)}});
  for (DiscoveryReport::Excluded const& each : discovery.excluded)
    out["left_out"].push_back({{"term", each.term}, {"reason", each.reason}});
  for (DiscoveredEquation const& equation : discovery.equations) {
    Json terms = Json::array(), supports = Json::array();
    for (DiscoveredTerm const& term : equation.terms) {
      terms.push_back({{"term", term.text},
                       {"name", term.name},
                       {"unit", term.unit},
                       {"kept", term.kept},
                       {"fate", word(term.fate)},
                       {"coefficient", term.coefficient},
                       {"sd", term.sd},
                       {"measure", term.measure},
                       {"mean", term.mean},
                       {"mean_sd", term.mean_sd},
                       {"contribution", term.contribution},
                       {"inflation", term.inflation}});
      if (term.measure_error > 0) terms.back()["measure_error"] = term.measure_error;
    }
    for (DiscoveredSupport const& support : equation.supports) {
      supports.push_back({{"terms", support.terms}, {"probability", support.probability}, {"log_evidence", support.log_evidence}});
      if (support.probability_error > 0) supports.back()["probability_error"] = support.probability_error;
    }
    Json found = {{"target", equation.target},
                  {"equation", equation.equation},
                  {"rows", equation.rows},
                  {"explained_of_projections", equation.explained},
                  {"noise_ratio", equation.noise_ratio},
                  {"own_noise", equation.own_noise},
                  {"exact", equation.exact},
                  {"converged", equation.converged},
                  {"terms", std::move(terms)},
                  {"supports", std::move(supports)}};
    if (!equation.moving_average.empty()) found["moving_average"] = equation.moving_average;
    out["equations"].push_back(std::move(found));
  }
  for (DifferenceForecast const& each : discovery.forecasts) {
    out["forecasts"].push_back({{"rows", discovery.forecast_rows},
                                {"target", each.target},
                                {"unit", each.unit},
                                {"sd", each.sd},
                                {"one_step", number_or_null(each.one_step)},
                                {"free_run", number_or_null(each.free_run)},
                                {"expected", number_or_null(each.expected)}});
  }
  if (discovery.validation) out["judged"] = validation_json(*discovery.validation);
  return out;
}

std::vector<std::pair<std::string, std::string>> discovery_files(Report const& report) {
  DiscoveryReport const& discovery = *report.discovery;
  std::string terms =
      csv_head(report) + "equation,term,name,unit,fate,kept,coefficient,sd,measure,mean,mean_sd,contribution,inflation\n";
  for (DiscoveredEquation const& equation : discovery.equations)
    for (DiscoveredTerm const& term : equation.terms)
      terms += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", csv_field(equation.target), csv_field(term.text),
                           csv_field(term.name), csv_field(term.unit), word(term.fate), term.kept ? 1 : 0,
                           shortest(term.coefficient), shortest(term.sd), shortest(term.measure), shortest(term.mean),
                           shortest(term.mean_sd), shortest(term.contribution), shortest(term.inflation));
  std::vector<std::pair<std::string, std::string>> files = {{"terms.csv", std::move(terms)}};
  if (discovery.validation)
    for (auto& file : validation_files(report, *discovery.validation)) files.push_back(std::move(file));
  if (!discovery.source.empty()) files.emplace_back("found.sysid", discovery.source);
  return files;
}

}  // namespace sysid
