// Two tables: of models by their evidence, of predictions by their errors, those of the same samples together.
#include "report/comparison.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "report/number.hpp"

namespace sysid {
namespace {

std::string fits_text(Comparison const& comparison) {
  std::vector<std::vector<std::string>> rows = {{"fit", "model", "noise", "parameters", "log evidence", "probability", "checks"}};
  std::string notes;
  for (ComparedFit const& fit : comparison.fits) {
    rows.push_back({fit.name, fit.model, fit.noise, std::to_string(fit.parameters),
                    fit.log_evidence ? fmt::format("{:.1f}", *fit.log_evidence) : "-",
                    fit.probability ? fmt::format("{:.3f}", *fit.probability) : "-", fit.pass ? "pass" : "doubtful"});
    if (!fit.log_evidence) notes += fmt::format("{} has no evidence: {}\n", fit.name, fit.without);
    if (fit.rough) notes += fmt::format("{}: its evidence is rough, {:+.1f} along the axes of its mode\n", fit.name, *fit.rough);
  }
  return fmt::format("fitted to {}; probabilities of the models under equal odds before the data\n\n{}{}{}", comparison.data,
                     align_columns(rows, 3), notes.empty() ? "" : "\n", notes);
}

std::string predictions_text(std::vector<ComparedPrediction> const& predictions) {
  std::string text;
  for (std::size_t first = 0; first < predictions.size();) {
    std::vector<std::vector<std::string>> rows = {{"prediction", "model", "from", "nmse [%]", "coverage_95", "checks"}};
    std::size_t last = first;
    ComparedPrediction const& one = predictions[first];
    for (; last < predictions.size() && predictions[last].samples == one.samples && predictions[last].on == one.on; ++last) {
      ComparedPrediction const& each = predictions[last];
      rows.push_back({each.name, each.model, each.kind, significant(each.nmse, 4),
                      each.coverage ? significant(*each.coverage, 4) : "-", each.pass ? "pass" : "doubtful"});
    }
    text += fmt::format("{}{}, rows {}\n\n{}", first == 0 ? "" : "\n", one.on, one.rows, align_columns(rows, 3));
    first = last;
  }
  return text;
}

}  // namespace

std::string comparison_text(Comparison const& comparison) {
  std::string text = comparison.fits.empty() ? "" : fits_text(comparison);
  if (!text.empty() && !comparison.predictions.empty()) text += "\n";
  return text + predictions_text(comparison.predictions);
}

std::string comparison_json(Comparison const& comparison) {
  using Json = nlohmann::ordered_json;
  auto const number = [](std::optional<double> const& value) { return value ? Json(*value) : Json(nullptr); };
  Json out = {{"data", comparison.data}, {"fits", Json::array()}, {"predictions", Json::array()}};
  for (ComparedFit const& fit : comparison.fits) {
    Json entry = {{"name", fit.name},
                  {"model", fit.model},
                  {"parameters", fit.parameters},
                  {"noise", fit.noise},
                  {"log_evidence", number(fit.log_evidence)},
                  {"rough", number(fit.rough)},
                  {"probability", number(fit.probability)},
                  {"pass", fit.pass}};
    if (!fit.log_evidence) entry["reason"] = fit.without;
    out["fits"].push_back(std::move(entry));
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
                                  {"samples_sha256", each.samples}});
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sysid
