// Moments for the tails, ranks for the growth.
#include "diagnostics/law/residual_law.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/numeric/elementary.hpp"
#include "core/numeric/statistics.hpp"

namespace sysid {
namespace {

constexpr std::size_t fewest_residuals = 30;
constexpr double most_memory = 2;  // sds of the correlation of neighbours

double upper_tail(double z) { return 0.5 * elementary::erfc(z / std::sqrt(2.0)); }

/// From 1; equal values share the mean of their ranks.
std::vector<double> ranks_of(std::vector<double> const& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> rank(values.size());
  for (std::size_t from = 0, to = 0; from < order.size(); from = to) {
    while (to < order.size() && values[order[to]] == values[order[from]]) ++to;
    for (std::size_t k = from; k < to; ++k) rank[order[k]] = 0.5 * static_cast<double>(from + to + 1);
  }
  return rank;
}

double correlation_of(std::vector<double> const& a, std::vector<double> const& b) {
  double const mean_a = mean(a), mean_b = mean(b);
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - mean_a) * (b[i] - mean_b);
  double const size = std::sqrt(squared_deviations(a, mean_a) * squared_deviations(b, mean_b));
  return size > 0 ? sum / size : 0;
}

/// Of the residuals whose predictions have ranks within (from, to].
double rms_between(std::vector<double> const& residuals, std::vector<double> const& rank, double from, double to) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < residuals.size(); ++i)
    if (rank[i] > from && rank[i] <= to) sum += residuals[i] * residuals[i], count += 1;
  return count > 0 ? std::sqrt(sum / count) : 0;
}

}  // namespace

double kurtosis_p(double b2, double n) {
  double const expected = 3 * (n - 1) / (n + 1);
  double const variance = 24 * n * (n - 2) * (n - 3) / ((n + 1) * (n + 1) * (n + 3) * (n + 5));
  double const x = (b2 - expected) / std::sqrt(variance);
  double const skewness =
      6 * (n * n - 5 * n + 2) / ((n + 7) * (n + 9)) * std::sqrt(6 * (n + 3) * (n + 5) / (n * (n - 2) * (n - 3)));
  double const a = 6 + 8 / skewness * (2 / skewness + std::sqrt(1 + 4 / (skewness * skewness)));
  double const below = 1 + x * std::sqrt(2 / (a - 4));
  if (!(below > 0)) return 1;  // far below what is expected
  return upper_tail((1 - 2 / (9 * a) - std::cbrt((1 - 2 / a) / below)) / std::sqrt(2 / (9 * a)));
}

ResidualLaw residual_law(std::span<double const> residuals, std::span<double const> predicted) {
  std::vector<double> values, sizes, along;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (!std::isfinite(residuals[i]) || !std::isfinite(predicted[i])) continue;
    values.push_back(residuals[i]);
    sizes.push_back(std::fabs(residuals[i]));
    along.push_back(std::fabs(predicted[i]));
  }
  ResidualLaw law;
  double const n = static_cast<double>(values.size()), centre = mean(values);
  if (values.size() < fewest_residuals) return law;
  double second = 0, fourth = 0;
  for (double const value : values) {
    double const square = (value - centre) * (value - centre);
    second += square / n;
    fourth += square * square / n;
  }
  if (!(second > 0)) return law;
  law.excess_kurtosis = fourth / (second * second) - 3;
  law.tail_p = kurtosis_p(law.excess_kurtosis + 3, n);
  std::vector<double> const rank = ranks_of(along);
  double const small = rms_between(values, rank, 0, n / 3), large = rms_between(values, rank, n - n / 3, n);
  if (!(small > 0)) return law;
  law.growth = large / small;
  // Of residuals with a memory the large ones lie together, and so may the large predictions.
  double next = 0;
  for (std::size_t i = 1; i < values.size(); ++i) next += (values[i] - centre) * (values[i - 1] - centre);
  if (next / (n * second) * std::sqrt(n) > most_memory) return law;
  law.growth_p = upper_tail(correlation_of(ranks_of(sizes), rank) * std::sqrt(n - 1));
  return law;
}

std::vector<double> in_growing_units(std::span<double const> residuals, std::span<double const> predicted,
                                     std::span<std::size_t const> far) {
  std::vector<double> values, along;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (!std::isfinite(residuals[i]) || !std::isfinite(predicted[i]) || std::ranges::binary_search(far, i)) continue;
    values.push_back(residuals[i]);
    along.push_back(std::fabs(predicted[i]));
  }
  std::vector<double> out(residuals.begin(), residuals.end());
  std::vector<double> const rank = ranks_of(along);
  double const n = static_cast<double>(values.size());
  auto const mean_square = [&](std::vector<double> const& of, double from, double to) {
    double const rms = rms_between(of, rank, from, to);
    return rms * rms;
  };
  double const small = mean_square(values, 0, n / 3), large = mean_square(values, n - n / 3, n);
  double const begin = mean_square(along, 0, n / 3), end = mean_square(along, n - n / 3, n);
  if (!(small > 0 && end > begin)) return out;
  double const slope = (large - small) / (end - begin);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] /= std::sqrt(std::max(small, small + slope * (predicted[i] * predicted[i] - begin)));
  return out;
}

}  // namespace sysid
