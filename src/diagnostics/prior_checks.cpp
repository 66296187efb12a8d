// Contraction compares 90 % intervals, which heavy tails do not affect.
#include "diagnostics/prior_checks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/numeric/statistics.hpp"
#include "core/text/number.hpp"
#include "search/mode_findings.hpp"

namespace sysid {

std::pair<double, double> interval_90(Summary const& summary) {
  if (std::isfinite(summary.q5) && std::isfinite(summary.q95) && summary.q95 > summary.q5) return {summary.q5, summary.q95};
  return {summary.mean - normal_quantile_95 * summary.sd, summary.mean + normal_quantile_95 * summary.sd};
}

std::optional<double> contraction(PriorInfo const& prior, Summary const& summary) {
  if (!prior.q5 || !prior.q95) return std::nullopt;
  auto const [low, high] = interval_90(summary);
  double const ratio = (*prior.q95 - *prior.q5) / (high - low);
  return std::isfinite(ratio) && ratio > 0 ? std::optional(ratio) : std::nullopt;
}

namespace {

/// Of a log-normal prior whose median stands where the mean of the logarithm was meant, or the other way round: the data lie within
/// its 90 % interval when it is read so. Else empty.
std::string other_reading(PriorInfo const& prior, double place) {
  if (!prior.numbers || prior.numbers->distribution != "log_normal" || !(place > 0)) return {};
  double const median = prior.numbers->arguments[0] / prior.numbers->scale,
               width = normal_quantile_95 * prior.numbers->arguments[1];
  if (std::abs(elementary::log(place) - median) <= width)
    return fmt::format(
        "; if {0:.10g} is meant as the mean of the logarithm, write `log_normal(log_mean = {0:.10g}, log_sd = {1:.10g})`", median,
        prior.numbers->arguments[1]);
  double const log_mean = elementary::log(median);
  if (log_mean > 0 && std::abs(elementary::log(place / log_mean)) <= width)
    return fmt::format("; if {0:.10g} is meant as the median, write `log_normal(median = {0:.10g}, log_sd = {1:.10g})`", log_mean,
                       prior.numbers->arguments[1]);
  return {};
}

enum class Beyond { neither, below, above };

Beyond side(PriorInfo const& prior, double place) {
  if (!prior.lowest || !prior.highest) return Beyond::neither;
  bool const below = place < *prior.lowest;
  if (!below && !(place > *prior.highest)) return Beyond::neither;
  // A prior that ends there has no tail to be in: that is another finding.
  constexpr double tail = 0.1;  // of the density where 5 % lie beyond
  if (prior.density(below ? *prior.lowest : *prior.highest) > tail * prior.density(below ? *prior.q5 : *prior.q95))
    return Beyond::neither;
  return below ? Beyond::below : Beyond::above;
}

bool agrees(Report const& report, Maxima const& maxima, Mode const& mode) {
  for (PriorInfo const& prior : report.priors)
    for (std::size_t p = 0; p < maxima.parameters.size() && p < mode.declared.size(); ++p)
      if (maxima.parameters[p].name == prior.name && side(prior, mode.declared[p]) != Beyond::neither) return false;
  return true;
}

bool another_agrees(Report const& report, Maxima const& maxima) {
  double const nearly_as_high = -elementary::log(notable_share);  // as `second_mode` has it, of a likelihood
  return !maxima.modes.empty() && std::ranges::any_of(maxima.modes.subspan(1), [&](Mode const& mode) {
    return mode.log_density > maxima.modes.front().log_density - nearly_as_high && agrees(report, maxima, mode);
  });
}

Finding contradicted(PriorInfo const& prior, double place, Beyond beyond, bool of_likelihood) {
  bool const below = beyond == Beyond::below;
  std::string const unit = unit_after_number(prior.unit);
  std::string const cause =
      of_likelihood ? "`ml` does not use the density of the prior, so this value comes from the data alone: widen the "
                      "prior before other fits, or find the cause in the data or the model"
                    : "data and prior disagree, and the posterior is a compromise: widen the prior, or find the cause in "
                      "the data or the model";
  return {FindingCode::prior_contradicted,
          Severity::warning,
          {prior.name},
          fmt::format("{} is estimated as {}{}, but its prior gives a probability of 0.0005 to values {} {}{}", prior.name,
                      significant(place, 4), unit, below ? "below" : "above",
                      significant(below ? *prior.lowest : *prior.highest, 4), unit),
          cause + other_reading(prior, place)};
}

}  // namespace

Findings check_priors(Report const& report, std::optional<Maxima> const& of_likelihood) {
  Findings findings;
  if (of_likelihood && another_agrees(report, *of_likelihood)) return findings;
  for (PriorInfo const& prior : report.priors)
    for (Summary const& summary : report.summary) {
      if (summary.name != prior.name || summary.coefficient) continue;
      double const place = std::isfinite(summary.median) ? summary.median : summary.mean;
      if (Beyond const beyond = side(prior, place); beyond != Beyond::neither)
        findings.push_back(contradicted(prior, place, beyond, of_likelihood.has_value()));
    }
  return findings;
}

std::string times_apart(double ratio) {
  return fmt::format("{} times {}", significant(ratio > 1 ? ratio : 1 / ratio, 2), ratio > 1 ? "larger" : "smaller");
}

Finding prior_far_from_data(std::vector<std::string> names, std::string message) {
  return {FindingCode::prior_far_from_data, Severity::warning, std::move(names), std::move(message),
          "check the units of the data columns, and priors that are wide or misplaced"};
}

namespace {

/// A prior that hardly lets its parameter move, as `precision` in the place of `sd` makes it.
bool fixes(PriorInfo const& prior) {
  constexpr double next_to_nothing = 1e-3;
  return *prior.q95 - *prior.q5 < next_to_nothing * std::max(std::fabs(*prior.q5), std::fabs(*prior.q95));
}

/// The misfit that is left may be that of a parameter which its prior has fixed elsewhere.
void name_fixed(std::string const& name, PriorInfo const& prior, Findings& findings) {
  for (Finding& each : findings)
    if (each.code == FindingCode::residuals_not_white)
      each.help += fmt::format("; or check the prior of {}, which is so narrow ({} to {}{}) that the data cannot change it", name,
                               significant(*prior.q5, 7), significant(*prior.q95, 7), unit_after_number(prior.unit));
}

}  // namespace

void name_held(Report const& report, Findings& findings) {
  std::vector<std::string> held;
  std::vector<PriorInfo const*> fixed;
  for (PriorInfo const& prior : report.priors)
    for (Summary const& summary : report.summary) {
      if (summary.name != prior.name || summary.coefficient) continue;
      auto const ratio = contraction(prior, summary);
      if (!ratio || !(*ratio < hardly_narrower)) continue;
      held.push_back(summary.name);
      if (fixes(prior)) fixed.push_back(&prior);
    }
  // Of many such priors most are meant so.
  constexpr std::size_t most_fixed = 2;
  for (PriorInfo const* prior : fixed)
    if (fixed.size() <= most_fixed) name_fixed(prior->name, *prior, findings);
  constexpr std::size_t most_named = 6;
  if (held.empty() || held.size() > most_named) return;
  for (Finding& each : findings)
    if (each.code == FindingCode::explains_little || each.code == FindingCode::worse_than_the_mean)
      each.help +=
          held.size() == 1
              ? fmt::format("; the posterior of {} is nearly as wide as its prior: check this prior", held.front())
              : fmt::format("; the posteriors of {} are nearly as wide as their priors: check these priors", fmt::join(held, ", "));
}

}  // namespace sysid
