// Histogram and kernel estimate.
#include "report/figure/marginal.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numeric/statistics.hpp"

namespace sysid {

Histogram::Histogram(std::vector<double> const& sorted, double from, double to) : low(from) {
  double const n = static_cast<double>(sorted.size());
  double const extent = to - low;
  double const quartiles = sorted_quantile(sorted, 0.75) - sorted_quantile(sorted, 0.25);
  double const rule = quartiles > 0 ? extent / (2 * quartiles / std::cbrt(n)) : 1;
  auto const bins = static_cast<std::size_t>(std::clamp(std::ceil(rule), 12.0, 40.0));
  width = extent > 0 ? extent / static_cast<double>(bins) : 1;
  density.assign(bins, 0);
  for (double const v : sorted)
    if (v >= from && v <= to) density[std::min(bins - 1, static_cast<std::size_t>((v - low) / width))] += 1 / (n * width);
}

double Histogram::peak() const { return *std::max_element(density.begin(), density.end()); }

std::vector<std::pair<double, double>> Histogram::outline(double from, double to) const {
  std::vector<std::pair<double, double>> out;
  for (std::size_t b = 0; b < density.size(); ++b) {
    double const begin = std::max(low + static_cast<double>(b) * width, from);
    double const end = std::min(low + static_cast<double>(b + 1) * width, to);
    if (begin >= end) continue;
    out.emplace_back(begin, density[b]);
    out.emplace_back(end, density[b]);
  }
  return out;
}

std::pair<double, double> shown_range(std::vector<double> const& sorted) {
  double const low = sorted_quantile(sorted, 0.01), high = sorted_quantile(sorted, 0.99);
  bool const long_tails = sorted.back() - sorted.front() > 8 * (high - low) && high > low;
  return long_tails ? std::pair{low, high} : std::pair(sorted.front(), sorted.back());
}

double support_end(std::function<double(double)> const& density, double inside, double towards) {
  if (!(density(inside) > 0) || density(towards) > 0) return towards;
  for (int k = 0; k < 60; ++k) {
    double const middle = inside + (towards - inside) / 2;
    (density(middle) > 0 ? inside : towards) = middle;
  }
  return inside;
}

double kernel_width(std::vector<double> const& sorted, double n) {
  if (sorted.size() < 2) return 0;
  double mean = 0, square = 0;
  for (double const v : sorted) mean += v / static_cast<double>(sorted.size());
  for (double const v : sorted) square += (v - mean) * (v - mean);
  double const sd = std::sqrt(square / static_cast<double>(sorted.size() - 1));
  double const quartiles = (sorted_quantile(sorted, 0.75) - sorted_quantile(sorted, 0.25)) / 1.34;
  return 0.9 * (quartiles > 0 ? std::min(sd, quartiles) : sd) * std::pow(std::max(n, 1.0), -0.2);
}

std::vector<double> kernel_density(std::vector<double> const& sorted, double n, double from, double to, int points, double lower,
                                   double upper) {
  double const h = kernel_width(sorted, n);
  double const size = std::max(std::fabs(from), std::fabs(to));
  if (!(h > 1e-13 * size) || !(to > from) || points < 2) return {};
  // Draws in cells a fifth of a kernel wide first: what they lose in place cannot be seen.
  double const cell = std::max(h / 5, (to - from) / 4000), reach = 5 * h;
  auto const cells = static_cast<std::size_t>(std::ceil((to - from + 2 * reach) / cell)) + 1;
  std::vector<double> mass(cells, 0);
  auto const add = [&](double v) {
    double const place = (v - (from - reach)) / cell;
    if (place >= 0 && place < static_cast<double>(cells)) mass[static_cast<std::size_t>(place)] += 1;
  };
  for (double const v : sorted) {
    add(v);
    if (std::isfinite(lower) && v - lower < reach) add(2 * lower - v);
    if (std::isfinite(upper) && upper - v < reach) add(2 * upper - v);
  }
  double const scale = 1 / (static_cast<double>(sorted.size()) * h * std::sqrt(2 * std::numbers::pi));
  std::vector<double> out;
  for (int k = 0; k < points; ++k) {
    double const at = from + (to - from) * k / (points - 1);
    double sum = 0;
    auto const first = static_cast<std::size_t>(std::max(0.0, (at - from) / cell));
    auto const last = std::min(cells, static_cast<std::size_t>((at - from + 2 * reach) / cell) + 1);
    for (std::size_t c = first; c < last; ++c) {
      double const z = (from - reach + (static_cast<double>(c) + 0.5) * cell - at) / h;
      sum += mass[c] * std::exp(-0.5 * z * z);
    }
    out.push_back(at < lower || at > upper ? 0 : scale * sum);
  }
  return out;
}

}  // namespace sysid
