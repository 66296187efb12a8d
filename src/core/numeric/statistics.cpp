// Sums in the order of the values; quantiles of sorted copies.
#include "core/numeric/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "core/numeric/elementary.hpp"

namespace sysid {
namespace {

/// sum exp(x - largest); only where the largest is finite.
struct Scaled {
  double largest, sum;
};

Scaled scaled_sum(std::span<double const> logs) {
  if (logs.empty()) return {-std::numeric_limits<double>::infinity(), 0};
  double const largest = *std::max_element(logs.begin(), logs.end());
  if (!std::isfinite(largest)) return {largest, 0};
  std::vector<double> terms(logs.size());
  for (std::size_t i = 0; i < logs.size(); ++i) terms[i] = logs[i] - largest;
  elementary::exp_lanes(terms.data(), terms.data(), static_cast<int>(terms.size()));
  return {largest, std::accumulate(terms.begin(), terms.end(), 0.0)};
}

}  // namespace

double mean(std::span<double const> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double squared_deviations(std::span<double const> values, double center) {
  double sum = 0;
  for (double const v : values) sum += (v - center) * (v - center);
  return sum;
}

double sample_variance(std::span<double const> values) {
  if (values.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  return squared_deviations(values, mean(values)) / static_cast<double>(values.size() - 1);
}

double population_variance(std::span<double const> values) {
  return squared_deviations(values, mean(values)) / static_cast<double>(values.size());
}

double corrected_mean(std::span<double const> values) {
  double const rough = mean(values);
  double rest = 0;
  for (double const v : values) rest += v - rough;
  return rough + rest / static_cast<double>(values.size());
}

double corrected_variance(std::span<double const> values) { return corrected_variance(values, corrected_mean(values)); }

double corrected_variance(std::span<double const> values, double center) {
  double sum = 0, rest = 0;
  for (double const v : values) {
    double const square = (v - center) * (v - center), next = sum + square;
    rest += sum > square ? sum - next + square : square - next + sum;
    sum = next;
  }
  return (sum + rest) / (static_cast<double>(values.size()) - 1);
}

double log_of_sum(double a, double b) {
  double const high = std::max(a, b), low = std::min(a, b);
  return high == -std::numeric_limits<double>::infinity() ? high : high + elementary::log1p(elementary::exp(low - high));
}

double log_of_sum(std::span<double const> logs) {
  Scaled const all = scaled_sum(logs);
  return std::isfinite(all.largest) ? all.largest + elementary::log(all.sum) : all.largest;
}

double log_of_mean(std::span<double const> logs) {
  Scaled const all = scaled_sum(logs);
  return std::isfinite(all.largest) ? all.largest + elementary::log(all.sum / static_cast<double>(logs.size())) : all.largest;
}

double effective_number(std::span<double const> weights) {
  double sum = 0, squares = 0;
  for (double const each : weights) sum += each, squares += each * each;
  return squares > 0 ? sum * sum / squares : 0;
}

std::vector<double> pooled(std::vector<std::vector<double>> const& chains) {
  std::vector<double> all;
  for (auto const& chain : chains) all.insert(all.end(), chain.begin(), chain.end());
  return all;
}

double sorted_quantile(std::vector<double> const& sorted, double probability) {
  double const index = static_cast<double>(sorted.size() - 1) * probability;
  double const low = std::floor(index);
  double const a = sorted[static_cast<std::size_t>(low)];
  double const b = sorted[static_cast<std::size_t>(std::ceil(index))];
  if (a == b) return a;  // exactly, or draws tied with the quantile would fall on the wrong side of it
  double const h = index - low;
  return (1 - h) * a + h * b;
}

PredictivePlace predictive_place(std::size_t draws, double probability) {
  auto const last = static_cast<double>(draws) - 1;
  double const place = std::clamp(probability * (last + 2) - 1, 0.0, last);
  auto const below = static_cast<std::size_t>(place);
  return {below, std::min(below + 1, draws - 1), place - std::floor(place)};
}

double predictive_quantile(std::span<double> draws, double probability) {
  auto const [below, above, share] = predictive_place(draws.size(), probability);
  auto const near = [draws](std::size_t count) { return draws.begin() + static_cast<std::ptrdiff_t>(count); };
  // A tail is a small part: sorted from its end, few of the others are moved.
  if (2 * above < draws.size()) {
    std::partial_sort(draws.begin(), near(above + 1), draws.end());
    return draws[below] + share * (draws[above] - draws[below]);
  }
  std::partial_sort(draws.begin(), near(draws.size() - below), draws.end(), std::greater<>());
  double const low = draws[draws.size() - 1 - below], high = draws[draws.size() - 1 - above];
  return low + share * (high - low);
}

double quantile(std::vector<double> draws, double probability) {
  if (draws.empty() || std::any_of(draws.begin(), draws.end(), [](double v) { return std::isnan(v); }))
    return std::numeric_limits<double>::quiet_NaN();
  std::sort(draws.begin(), draws.end());
  return sorted_quantile(draws, probability);
}

double median(std::vector<double> draws) { return quantile(std::move(draws), 0.5); }

double upper_median(std::vector<double> draws) {
  auto const middle = draws.begin() + static_cast<std::ptrdiff_t>(draws.size() / 2);
  std::nth_element(draws.begin(), middle, draws.end());
  return *middle;
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
