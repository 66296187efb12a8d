// Contraction compares 90 % intervals, which heavy tails do not affect.
#include "diagnostics/prior_checks.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/numeric/statistics.hpp"
#include "core/text/number.hpp"

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

std::string times_apart(double ratio) {
  return fmt::format("{} times {}", significant(ratio > 1 ? ratio : 1 / ratio, 2), ratio > 1 ? "larger" : "smaller");
}

Finding prior_far_from_data(std::vector<std::string> names, std::string message) {
  return {FindingCode::prior_far_from_data, Severity::warning, std::move(names), std::move(message),
          "check the units of the data columns, and priors that are wide or misplaced"};
}

}  // namespace sysid
