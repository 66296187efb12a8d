// Two stored fits in words: what the record prefers, how large the disturbance is, and which parameters it moves or widens.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/comparison/compare.hpp"
#include "app/disturbed/disturbance_advice.hpp"
#include "app/disturbed/fit_disturbed.hpp"
#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "report/file/stored_files.hpp"

namespace sysid {
namespace {

using OrderedJson = nlohmann::ordered_json;  // parameters in the order of the model

struct Estimate {
  double mean = 0, sd = 0;
  std::string unit;
};

std::optional<Estimate> estimate(OrderedJson const& summary, std::string const& name) {
  OrderedJson const all = summary.value("parameters", OrderedJson::object());
  if (!all.contains(name)) return std::nullopt;
  OrderedJson const& one = all.at(name);
  if (!one.contains("mean") || !one["mean"].is_number() || !one.contains("sd") || !one["sd"].is_number()) return std::nullopt;
  return Estimate{one["mean"].get<double>(), one["sd"].get<double>(), one.value("unit", "")};
}

/// "0.9982 ± 0.0031".
std::string with_sd(Estimate const& of) { return fmt::format("{} ± {}", significant(of.mean, 4), significant(of.sd, 2)); }

/// Of a summary, without notes.
Findings findings_in(OrderedJson const& summary) {
  Findings findings;
  for (auto const& each : summary.value("findings", OrderedJson::array()))
    if (auto const code = finding_code(each.value("code", "")); code && each.value("severity", "") != "note")
      findings.push_back({*code, Severity::warning, {}, each.value("message", ""), ""});
  return findings;
}

/// Which of both the record prefers. Nothing is said of an evidence that is not there.
std::string preference(Comparison const& comparison, FoundByBoth const& found, ExplainedShares const& shares) {
  if (comparison.fits.size() != 2 || !comparison.fits[0].log_bayes_factor || !comparison.fits[1].log_bayes_factor)
    return "one of the evidences is not known, so the models cannot be compared by their evidence; compare the residuals of both "
           "fits\n";
  double const factor = *comparison.fits[1].log_evidence - *comparison.fits[0].log_evidence;
  std::string const size = fmt::format("log Bayes factor {:+.1f}", factor);
  if (factor >= 3) return advice_on_disturbance(size, found, shares);
  if (factor <= -3) return fmt::format("the record prefers the model without the disturbance: {}\n", size);
  return fmt::format("the record does not decide between the two models: {}\n", size);
}

/// How large the disturbance is in the estimate's own words.
std::string sizes(OrderedJson const& with, std::vector<DisturbedEquation> const& equations) {
  std::string text;
  OrderedJson const parameters = with.value("parameters", OrderedJson::object());
  for (auto const& [name, entry] : parameters.items())
    for (DisturbedEquation const& each : equations) {
      std::string const quantity = each.parameter();
      if (name != quantity && !name.ends_with("." + quantity)) continue;
      // In a part, with the name of the part; another part may have one of the same name, but not the same parameter.
      std::string const part = name.substr(0, name.size() - quantity.size());
      // An optimum at a bound has no sd of what is derived from it.
      std::string const rms = part + each.name + "_rms";
      bool const by_rms = each.white() && estimate(with, rms);
      if (auto const value = estimate(with, by_rms ? rms : name))
        text += fmt::format("{}{}: {}{} {}\n", part, each.name, with_sd(*value), unit_after_number(value->unit),
                            each.discrete   ? "rms of its samples"
                            : !each.white() ? "rms"
                            : by_rms        ? "rms of its mean over a sampling interval"
                                            : "intensity");
      break;
    }
  return text;
}

std::string changes(OrderedJson const& without, OrderedJson const& with) {
  std::vector<std::vector<std::string>> rows = {{"", "unit", "without", "with", "shift [sd]", "sd ratio"}};
  OrderedJson const parameters = with.value("parameters", OrderedJson::object());
  for (auto const& [name, entry] : parameters.items()) {
    auto const before = estimate(without, name), after = estimate(with, name);
    if (!before || !after) continue;
    bool const known = after->sd > 0;
    rows.push_back({name, after->unit, with_sd(*before), with_sd(*after),
                    known ? fmt::format("{:+.1f}", (after->mean - before->mean) / after->sd) : "-",
                    known && before->sd > 0 ? significant(after->sd / before->sd, 2) : "-"});
  }
  return "what the disturbance changes; shift: change of the mean, in sds of the fit with the disturbance\n\n" +
         align_columns(rows, 2);
}

}  // namespace

std::string disturbance_words(std::filesystem::path const& without, std::filesystem::path const& with,
                              std::vector<DisturbedEquation> const& equations, ExplainedShares const& shares) {
  auto const before = OrderedJson::parse(read_whole_summary(without)), after = OrderedJson::parse(read_whole_summary(with));
  Comparison const comparison = compare({without, with});
  std::string text = comparison_text(comparison) + "\n" +
                     preference(comparison, {findings_in(before), findings_in(after)}, shares) + sizes(after, equations) + "\n";
  return text + changes(before, after);
}

}  // namespace sysid
