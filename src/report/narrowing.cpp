// By intervals of 90 %, which heavy tails leave alone.
#include "report/narrowing.hpp"

#include <cmath>

namespace sysid {

std::pair<double, double> interval_90(Summary const& summary) {
  if (std::isfinite(summary.q5) && std::isfinite(summary.q95) && summary.q95 > summary.q5) return {summary.q5, summary.q95};
  constexpr double half = 1.6448536269514722;  // the normal's 95 % quantile
  return {summary.mean - half * summary.sd, summary.mean + half * summary.sd};
}

std::optional<double> narrowing(PriorInfo const& prior, Summary const& summary) {
  if (!prior.q5 || !prior.q95) return std::nullopt;
  auto const [low, high] = interval_90(summary);
  double const ratio = (*prior.q95 - *prior.q5) / (high - low);
  return std::isfinite(ratio) && ratio > 0 ? std::optional(ratio) : std::nullopt;
}

}  // namespace sysid
