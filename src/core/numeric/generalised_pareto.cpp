// Sums in the order of the values; logarithms and exponentials from core/numeric/elementary, so the bits are those of every
// processor.
#include "core/numeric/generalised_pareto.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/numeric/elementary.hpp"

namespace sysid {
namespace {

constexpr double none = std::numeric_limits<double>::infinity();
constexpr int shortest_tail = 5;

// Mean of log(1 - theta x), which is the k that is likeliest with this theta = -k / sigma. terms: [x.size()] to work in.
double shape_given(double theta, std::span<double const> x, std::vector<double>& terms) {
  for (std::size_t i = 0; i < x.size(); ++i) terms[i] = -theta * x[i];
  elementary::log1p_lanes(terms.data(), terms.data(), static_cast<int>(terms.size()));
  return std::accumulate(terms.begin(), terms.end(), 0.0) / static_cast<double>(x.size());
}

// Ten observations' worth of belief in k = 1/2.
double towards_a_half(double k, double n) {
  constexpr double weight = 10;
  return (k * n + weight * 0.5) / (n + weight);
}

}  // namespace

double GeneralisedPareto::quantile(double probability) const {
  double const exponential = -elementary::log1p(-probability);
  return k == 0 ? sigma * exponential : sigma * elementary::expm1(k * exponential) / k;
}

GeneralisedPareto fit_generalised_pareto(std::span<double const> rising) {
  auto const n = static_cast<double>(rising.size());
  constexpr double prior = 3;
  int const points = 30 + static_cast<int>(std::sqrt(n));
  double const quartile = rising[static_cast<std::size_t>(n / 4 + 0.5) - 1];
  if (!(quartile > 0)) return {none, 0};
  std::vector<double> theta, log_likelihood, terms(rising.size());
  for (int j = 1; j <= points; ++j) {
    theta.push_back(1 / rising.back() + (1 - std::sqrt(points / (j - 0.5))) / prior / quartile);
    double const k = shape_given(theta.back(), rising, terms);
    log_likelihood.push_back(n * (elementary::log(-theta.back() / k) - k - 1));
  }
  double const largest = *std::max_element(log_likelihood.begin(), log_likelihood.end());
  double weights = 0, sum = 0;
  for (std::size_t j = 0; j < theta.size(); ++j) {
    double const weight = elementary::exp(log_likelihood[j] - largest);
    weights += weight;
    sum += weight * theta[j];
  }
  double const k = shape_given(sum / weights, rising, terms);
  GeneralisedPareto const fit{towards_a_half(k, n), -k / (sum / weights)};
  return std::isfinite(fit.k) && fit.sigma > 0 ? fit : GeneralisedPareto{none, 0};
}

int pareto_tail_length(int draws, double relative_efficiency) {
  return static_cast<int>(std::ceil(std::min(0.2 * draws, 3 * std::sqrt(draws / relative_efficiency))));
}

SmoothedWeights smooth_weights(std::span<double const> log_ratios, int tail_length) {
  SmoothedWeights out{{log_ratios.begin(), log_ratios.end()}, none};
  auto const draws = static_cast<int>(log_ratios.size());
  if (tail_length < shortest_tail || tail_length >= draws) return out;
  std::vector<int> order(log_ratios.size());
  std::iota(order.begin(), order.end(), 0);
  auto const value = [&](int place) { return log_ratios[static_cast<std::size_t>(place)]; };
  auto const below = [&](int a, int b) { return value(a) < value(b) || (value(a) == value(b) && a < b); };
  auto const first = order.end() - tail_length;  // of the tail
  std::nth_element(order.begin(), first, order.end(), below);
  std::sort(first, order.end(), below);
  double const largest = value(order.back());
  if (!(largest - value(*first) >= std::numeric_limits<double>::epsilon() / 100)) {
    if (std::isfinite(largest)) out.k = -none;
    return out;
  }
  double const threshold = elementary::exp(value(*std::max_element(order.begin(), first, below)) - largest);
  std::vector<double> exceedances;
  for (auto each = first; each != order.end(); ++each) exceedances.push_back(elementary::exp(value(*each) - largest) - threshold);
  GeneralisedPareto const fit = fit_generalised_pareto(exceedances);
  out.k = fit.k;
  if (!std::isfinite(fit.k)) return out;
  for (int i = 0; i < tail_length; ++i) {
    double const smoothed = elementary::log(fit.quantile((i + 0.5) / tail_length) + threshold);
    out.log_weights[static_cast<std::size_t>(first[i])] = std::min(smoothed, 0.0) + largest;
  }
  return out;
}

}  // namespace sysid
