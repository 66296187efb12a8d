// Two tables: of models by their evidence, of predictions by their errors, those of the same samples together.
#include "report/page/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <span>

#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "report/text/report_text.hpp"
#include "result/report.hpp"

namespace sysid {
namespace {

std::string checks_text(bool pass, int warnings) {
  if (!pass) return "doubtful";
  return warnings == 0 ? "pass" : counted(warnings, "warning");
}

/// To that many decimals, never "-0", with an error that is not zero at them.
std::string with_error(double value, std::optional<double> error, int decimals) {
  double const unit = std::pow(10.0, -decimals);
  std::string text = fmt::format("{:.{}f}", std::fabs(value) < 0.5 * unit ? 0 : value, decimals);
  if (error.value_or(0) >= 0.5 * unit) text += fmt::format(" ± {:.{}f}", *error, decimals);
  return text;
}

/// Three decimals, of which none reads as certain.
std::string model_probability(double p, std::optional<double> error) {
  if (p < 0.0005) return "< 0.001";
  return p >= 0.9995 ? "> 0.999" : with_error(p, error, 3);
}

/// Places of the fits, the best first; those without an evidence last, in their order.
std::vector<std::size_t> best_first(std::vector<ComparedFit> const& fits) {
  std::vector<std::size_t> order(fits.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  auto const evidence = [&](std::size_t f) { return fits[f].log_evidence.value_or(-std::numeric_limits<double>::infinity()); };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return evidence(a) > evidence(b); });
  return order;
}

ReportTable fits_table(Comparison const& comparison) {
  ReportTable table;
  table.title = fmt::format("fitted to {}; probabilities of the models for equal prior probabilities", comparison.data);
  table.header = {"fit",         "model", "noise", "parameters", "log evidence", "log Bayes factor", "evidence against",
                  "probability", "checks"};
  for (std::size_t const f : best_first(comparison.fits)) {
    ComparedFit const& fit = comparison.fits[f];
    table.rows.push_back({fit.name, fit.model, fit.noise, std::to_string(fit.parameters),
                          fit.log_evidence ? evidence_number(*fit.log_evidence, fit.error) : "-",
                          fit.log_bayes_factor ? with_error(*fit.log_bayes_factor, fit.bayes_factor_error, 1) : "-",
                          fit.strength.empty() ? "-" : fit.strength,
                          fit.probability ? model_probability(*fit.probability, fit.probability_error) : "-",
                          checks_text(fit.pass, fit.warnings)});
    std::string note;
    if (!fit.log_evidence) note = fmt::format("`{}` has no evidence: {}", fit.name, fit.without);
    if (fit.rough)
      note =
          fmt::format("the evidence of `{}` is approximate: {} changes it by {:+.1f}", fit.name,
                      fit.rough_by_draws ? "the estimate by weighted draws" : "integration along the axes of its mode", *fit.rough);
    if (!fit.not_confirmed.empty()) note = fmt::format("the evidence of `{}` is not confirmed: {}", fit.name, fit.not_confirmed);
    if (!note.empty()) table.caption += (table.caption.empty() ? "" : "\n") + note;
  }
  return table;
}

/// An error, of which there is none where a score is infinite.
std::string known(double error) { return std::isnan(error) ? "-" : fmt::format("{:.1f}", error); }

/// Of fits with draws, by what each says of samples that it has not seen.
ReportTable scores_table(ComparedScores const& scores) {
  ReportTable table;
  table.title = fmt::format("expected log predictive density (elpd) of {}, {}", counted(scores.samples, "sample"),
                            scores.future ? "each tenth of the record predicted from the rows before it (leave-future-out)"
                                          : "each left out (leave-one-out)");
  table.header = {"fit", "model", "elpd", "error", "difference", "error of difference", "stacking weight", "pseudo-BMA+ weight"};
  for (ComparedScore const& fit : scores.fits) {
    table.rows.push_back({fit.name, fit.model, fmt::format("{:.1f}", fit.elpd), known(fit.error),
                          std::isnan(fit.difference) ? "-" : with_error(fit.difference, {}, 1), known(fit.difference_error),
                          fmt::format("{:.3f}", fit.stacking), fmt::format("{:.3f}", fit.pseudo_bma)});
    if (fit.doubtful > 0 && !scores.future)
      table.caption += fmt::format("{}`{}`: Pareto's k is too large for {}, so its elpd is too high",
                                   table.caption.empty() ? "" : "\n", fit.name, counted(fit.doubtful, "sample"));
    if (fit.impossible > 0)
      table.caption += fmt::format("{}{}: the density of {} is zero under all draws, so this fit has no weight",
                                   table.caption.empty() ? "" : "\n", fit.name, counted(fit.impossible, "sample"));
  }
  std::vector<std::string> one_step;
  for (ComparedScore const& fit : scores.fits)
    if (fit.one_step) one_step.push_back(fit.name);
  if (scores.future && !one_step.empty())
    table.caption += fmt::format(
        "{}{}: only the parameters are estimated from the rows before that tenth; each sample is predicted one step ahead, from "
        "measured samples",
        table.caption.empty() ? "" : "\n", listed(one_step));
  if (scores.in_time && !scores.future)
    table.caption += fmt::format(
        "{}the rows follow one another in time: leave-one-out shows how well a model interpolates, not how "
        "well it predicts what comes next",
        table.caption.empty() ? "" : "\n");
  return table;
}

/// Of predictions of the same samples, which stand one after another.
ReportTable predictions_table(std::span<ComparedPrediction const> predictions) {
  ReportTable table;
  table.title = fmt::format("{}, rows {}", predictions.front().on, predictions.front().rows);
  table.header = {"prediction", "model", "from", "nmse [%]", "coverage_95", "checks"};
  for (ComparedPrediction const& each : predictions)
    table.rows.push_back({each.name, each.model, each.kind, significant(each.nmse, 4),
                          each.coverage ? significant(*each.coverage, 4) : "-", checks_text(each.pass, each.warnings)});
  // Models without a past predict in one way only.
  if (std::all_of(predictions.begin(), predictions.end(), [](ComparedPrediction const& each) { return each.kind.empty(); })) {
    constexpr std::ptrdiff_t kind = 2;
    table.header.erase(table.header.begin() + kind);
    for (auto& row : table.rows) row.erase(row.begin() + kind);
  }
  return table;
}

/// A header of several words in two rows, its last word below: columns of numbers are no wider than they need.
std::vector<std::vector<std::string>> stacked(std::vector<std::string> const& header) {
  std::vector<std::vector<std::string>> rows(2);
  for (std::string const& label : header) {
    auto const space = label.find('[') == std::string::npos ? label.rfind(' ') : std::string::npos;
    rows[0].push_back(space == std::string::npos ? "" : label.substr(0, space));
    rows[1].push_back(space == std::string::npos ? label : label.substr(space + 1));
  }
  if (std::all_of(rows[0].begin(), rows[0].end(), [](std::string const& above) { return above.empty(); })) rows.erase(rows.begin());
  return rows;
}

}  // namespace

std::vector<ReportTable> comparison_tables(Comparison const& comparison) {
  std::vector<ReportTable> tables;
  if (!comparison.fits.empty()) tables.push_back(fits_table(comparison));
  if (!comparison.scores.fits.empty()) tables.push_back(scores_table(comparison.scores));
  auto const& all = comparison.predictions;
  for (auto first = all.begin(); first != all.end();) {
    auto const last = std::find_if(
        first, all.end(), [&](ComparedPrediction const& each) { return each.samples != first->samples || each.on != first->on; });
    tables.push_back(predictions_table({first, last}));
    first = last;
  }
  return tables;
}

std::string comparison_text(Comparison const& comparison) {
  std::string text;
  for (ReportTable const& table : comparison_tables(comparison)) {
    std::vector<std::vector<std::string>> rows = stacked(table.header);
    rows.insert(rows.end(), table.rows.begin(), table.rows.end());
    text += fmt::format("{}{}\n\n{}", text.empty() ? "" : "\n", table.title, align_columns(rows, 3));
    if (!table.caption.empty()) text += "\n" + table.caption + "\n";
  }
  if (!comparison.notes.empty()) text += "\n";
  for (std::string const& note : comparison.notes) text += note + "\n";
  return text;
}

std::string comparison_json(Comparison const& comparison) {
  using Json = nlohmann::ordered_json;
  auto const number = [](std::optional<double> const& value) { return value ? Json(*value) : Json(nullptr); };
  Json out = {{"data", comparison.data}, {"fits", Json::array()}, {"predictions", Json::array()}, {"notes", comparison.notes}};
  for (ComparedFit const& fit : comparison.fits) {
    Json entry = {{"name", fit.name},
                  {"model", fit.model},
                  {"parameters", fit.parameters},
                  {"noise", fit.noise},
                  {"log_evidence", number(fit.log_evidence)},
                  {"standard_error", number(fit.error)},
                  {"not_confirmed", fit.not_confirmed.empty() ? Json(nullptr) : Json(fit.not_confirmed)},
                  {"log_bayes_factor", number(fit.log_bayes_factor)},
                  {"log_bayes_factor_error", number(fit.bayes_factor_error)},
                  {"strength", fit.strength},
                  {"rough", number(fit.rough)},
                  {"probability", number(fit.probability)},
                  {"probability_error", number(fit.probability_error)},
                  {"pass", fit.pass},
                  {"warnings", fit.warnings}};
    if (!fit.log_evidence) entry["reason"] = fit.without;
    out["fits"].push_back(std::move(entry));
  }
  if (ComparedScores const& scores = comparison.scores; !scores.fits.empty()) {
    out["scores"] = {{"by", scores.future ? "leave_future_out" : "leave_one_out"},
                     {"in_time", scores.in_time},
                     {"samples", scores.samples},
                     {"fits", Json::array()}};
    for (ComparedScore const& fit : scores.fits)
      out["scores"]["fits"].push_back({{"name", fit.name},
                                       {"model", fit.model},
                                       {"elpd", fit.elpd},
                                       {"error", fit.error},
                                       {"difference", fit.difference},
                                       {"difference_error", fit.difference_error},
                                       {"stacking", fit.stacking},
                                       {"pseudo_bma", fit.pseudo_bma},
                                       {"doubtful", fit.doubtful},
                                       {"impossible", fit.impossible}});
  }
  for (ComparedPrediction const& each : comparison.predictions)
    out["predictions"].push_back({{"name", each.name},
                                  {"model", each.model},
                                  {"from", each.kind},
                                  {"on", each.on},
                                  {"rows", each.rows},
                                  {"nmse", each.nmse},
                                  {"coverage_95", number(each.coverage)},
                                  {"pass", each.pass},
                                  {"warnings", each.warnings},
                                  {"samples_sha256", each.samples}});
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sysid
