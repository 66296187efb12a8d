// Quantiles.
#include "core/numeric/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sysid {

double sorted_quantile(std::vector<double> const& sorted, double probability) {
  double const index = static_cast<double>(sorted.size() - 1) * probability;
  double const low = std::floor(index);
  double const a = sorted[static_cast<std::size_t>(low)];
  double const b = sorted[static_cast<std::size_t>(std::ceil(index))];
  if (a == b) return a;  // exactly, or draws tied with the quantile would fall on the wrong side of it
  double const h = index - low;
  return (1 - h) * a + h * b;
}

double predictive_quantile(std::vector<double> const& sorted, double probability) {
  auto const last = static_cast<double>(sorted.size()) - 1;
  double const place = std::clamp(probability * (last + 2) - 1, 0.0, last);
  auto const below = static_cast<std::size_t>(place);
  std::size_t const above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

double quantile(std::vector<double> draws, double probability) {
  if (draws.empty() || std::any_of(draws.begin(), draws.end(), [](double v) { return std::isnan(v); }))
    return std::numeric_limits<double>::quiet_NaN();
  std::sort(draws.begin(), draws.end());
  return sorted_quantile(draws, probability);
}

std::pair<double, double> finite_range(std::vector<double> const& values) {
  std::pair<double, double> out(0, 1);
  bool first = true;
  for (double const v : values) {
    if (!std::isfinite(v)) continue;
    out = first ? std::pair(v, v) : std::pair(std::min(out.first, v), std::max(out.second, v));
    first = false;
  }
  return out;
}

}  // namespace sysid
