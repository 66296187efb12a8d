// Correlation and size of residuals.
#include "diagnostics/residuals/residual_tests.hpp"

#include <algorithm>
#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <limits>

#include "core/numeric/elementary.hpp"

namespace sysid {
namespace {

constexpr double two_sided_99 = 2.5758293035489004;  // normal quantile of 0.995

double mean_of(std::span<double const> x) {
  double sum = 0, count = 0;
  for (double const v : x) {
    if (std::isnan(v)) continue;
    sum += v;
    ++count;
  }
  return sum / count;
}

/// Of equal samples the mean is not always exact, and what it leaves is no variance.
bool constant(std::span<double const> x) {
  double first = std::numeric_limits<double>::quiet_NaN();
  for (double const v : x) {
    if (std::isnan(v)) continue;
    if (std::isnan(first)) first = v;
    if (v != first) return false;
  }
  return true;
}

struct Products {
  double sum = 0;
  double pairs = 0;
};

/// Sum over t of (a_(t+lag) - mean_a)(b_t - mean_b), where both are there.
Products products(std::span<double const> a, double mean_a, std::span<double const> b, double mean_b, std::size_t lag) {
  Products result;
  std::size_t const n = std::min(a.size(), b.size());
  for (std::size_t t = 0; t + lag < n; ++t) {
    double const product = (a[t + lag] - mean_a) * (b[t] - mean_b);
    if (std::isnan(product)) continue;
    result.sum += product;
    ++result.pairs;
  }
  return result;
}

/// Of Q in `whiteness`, for normal noise; bulk: by chi-squared.
double tail_of(double q, double lags, double samples, double bulk) {
  constexpr double tail = 0.01;
  if (bulk >= tail) return bulk;
  double const share = lags / samples, variance = 2 * lags * (1 + 2 * share), skewness = std::sqrt(8 / lags) * (1 + 8 * share);
  double const shape = 4 / (skewness * skewness), x = shape + std::sqrt(shape / variance) * (q - lags);
  return std::max(bulk, std::min(tail, boost::math::gamma_q(shape, std::max(x, 0.0))));
}

/// The x for which a Poisson variable of this mean is at most x with this probability, between whole numbers by gamma_q.
double lowest_events(double mean, double probability) {
  double low = 0, high = mean;
  for (int halved = 0; halved < 60; ++halved) {
    double const middle = 0.5 * (low + high);
    (boost::math::gamma_q(middle + 1, mean) < probability ? low : high) = middle;
  }
  return low;
}

/// The x for which a gamma variable of this shape is below x with this probability; 0 where nothing is free.
double lowest_square(double shape, double probability) { return shape > 0 ? boost::math::gamma_p_inv(shape, probability) : 0; }

int usable_lags(double samples, int lags) { return std::min(lags, static_cast<int>(samples / 4)); }

}  // namespace

double limit_together(std::span<double const> p_values) {
  auto const n = static_cast<double>(p_values.size());
  auto const k = static_cast<double>(std::count_if(p_values.begin(), p_values.end(), [](double p) { return p < rare; }));
  if (k == 0) return rare;
  return k > 1 && boost::math::ibeta(k, n - k + 1, rare) < rare ? rare : rare / n;
}

double trend_p_value(std::span<double const> residuals) {
  constexpr std::size_t least = 5, most = 200;
  std::vector<double> there;
  for (double const each : residuals)
    if (!std::isnan(each)) there.push_back(each);
  if (there.size() < least || there.size() > most) return 1;
  double rising = 0;
  for (std::size_t j = 0; j < there.size(); ++j)
    for (std::size_t i = 0; i < j; ++i) rising += there[j] > there[i] ? 1 : there[j] < there[i] ? -1 : 0;
  auto const n = static_cast<double>(there.size());
  double const z = (std::fabs(rising) - 1) / std::sqrt(n * (n - 1) * (2 * n + 5) / 18);
  return z > 0 ? boost::math::gamma_q(0.5, z * z / 2) : 1;
}

CorrelationTest whiteness(std::span<double const> residuals, int lags) {
  CorrelationTest test;
  test.first_lag = 1;
  auto const [power, samples] = products(residuals, 0, residuals, 0, 0);
  int const count = usable_lags(samples, lags);
  if (count < 1 || !(power > 0)) return test;
  double q = 0;
  int used = 0;
  for (int k = 1; k <= count; ++k) {
    auto const [sum, pairs] = products(residuals, 0, residuals, 0, static_cast<std::size_t>(k));
    double const r = sum / power;
    test.correlation.push_back(r);
    test.bound.push_back(two_sided_99 * std::sqrt(pairs / (samples * (samples + 2))));
    if (pairs == 0) continue;
    q += r * r * samples * (samples + 2) / pairs;
    ++used;
    if (std::fabs(r) > test.bound.back()) ++test.outside;
  }
  if (used == 0) return test;
  test.p_value = boost::math::gamma_q(0.5 * used, 0.5 * q);
  test.tail_p_value = tail_of(q, used, samples, test.p_value);
  return test;
}

CorrelationTest input_correlation(std::span<double const> residuals, std::span<double const> input, int lags) {
  CorrelationTest test;
  double const mean_e = mean_of(residuals), mean_u = mean_of(input);
  auto const e = products(residuals, mean_e, residuals, mean_e, 0);
  auto const u = products(input, mean_u, input, mean_u, 0);
  int const count = usable_lags(std::min(e.pairs, u.pairs), lags);
  if (count < 1 || !(e.sum > 0) || !(u.sum > 0) || constant(residuals) || constant(input)) return test;
  double const sd = std::sqrt(e.sum / e.pairs) * std::sqrt(u.sum / u.pairs);
  double colour = 1;
  for (int k = 1; k <= count; ++k) {
    auto const lag = static_cast<std::size_t>(k);
    colour += 2 * products(residuals, mean_e, residuals, mean_e, lag).sum / e.sum *
              products(input, mean_u, input, mean_u, lag).sum / u.sum;
  }
  colour = std::max(colour, 0.25);  // an estimate: sampling error must not shrink the bounds to nothing
  double largest = 0;
  int used = 0;
  for (int k = 0; k <= count; ++k) {
    auto const [sum, pairs] = products(residuals, mean_e, input, mean_u, static_cast<std::size_t>(k));
    double const r = pairs > 0 ? sum / (pairs * sd) : 0;
    test.correlation.push_back(r);
    test.bound.push_back(two_sided_99 * std::sqrt(colour / std::max(1.0, pairs)));
    if (pairs == 0) continue;
    ++used;
    largest = std::max(largest, std::fabs(r) * std::sqrt(pairs / colour));
    if (std::fabs(r) > test.bound.back()) ++test.outside;
  }
  double const one_lag = elementary::erfc(largest / std::sqrt(2.0));
  test.p_value = test.tail_p_value = -elementary::expm1(used * elementary::log1p(-one_lag));
  return test;
}

double nmse(std::span<double const> observed, std::span<double const> predicted) {
  if (constant(observed)) return std::numeric_limits<double>::quiet_NaN();
  double const mean = mean_of(observed);
  double misfit = 0, variance = 0;
  for (std::size_t t = 0; t < std::min(observed.size(), predicted.size()); ++t) {
    if (std::isnan(observed[t])) continue;
    misfit += (observed[t] - predicted[t]) * (observed[t] - predicted[t]);
    variance += (observed[t] - mean) * (observed[t] - mean);
  }
  return variance > 0 ? 100 * misfit / variance : std::numeric_limits<double>::quiet_NaN();
}

double nmse_of_logarithms(std::span<double const> observed, std::span<double const> predicted) {
  std::vector<double> logarithms, of_predicted;
  for (std::size_t t = 0; t < std::min(observed.size(), predicted.size()); ++t) {
    if (!(observed[t] > 0 && predicted[t] > 0)) continue;
    logarithms.push_back(elementary::log(observed[t]));
    of_predicted.push_back(elementary::log(predicted[t]));
  }
  return nmse(logarithms, of_predicted);
}

double rmse(std::span<double const> observed, std::span<double const> predicted) {
  double square = 0, samples = 0;
  for (std::size_t t = 0; t < std::min(observed.size(), predicted.size()); ++t) {
    if (std::isnan(observed[t])) continue;
    square += (observed[t] - predicted[t]) * (observed[t] - predicted[t]);
    ++samples;
  }
  return std::sqrt(square / samples);
}

ChiSquaredTest chi_squared(std::span<double const> standardised, double excess_kurtosis, int together, int fitted) {
  auto const [sum, samples] = products(standardised, 0, standardised, 0, 0);
  if (samples == 0) return {};
  double const half = samples / (2 + excess_kurtosis), tail = 5e-4 / together;
  return {sum / samples, lowest_square(half * (1 - fitted / samples), tail) / half, boost::math::gamma_q_inv(half, tail) / half};
}

ChiSquaredTest chi_squared_of_counts(std::span<double const> standardised, std::span<double const> degrees, int together,
                                     int fitted) {
  double square = 0, worth = 0, squared_worth = 0, samples = 0;
  for (std::size_t i = 0; i < standardised.size(); ++i) {
    if (std::isnan(standardised[i])) continue;
    double const sized = standardised[i] * std::sqrt(degrees[i]);  // first, as a square of a rare event may overflow
    square += sized * sized;
    worth += degrees[i];
    squared_worth += degrees[i] * degrees[i];
    ++samples;
  }
  if (!(worth > 0)) return {};
  double const half = worth / 2, free = half * (1 - fitted / samples), tail = 5e-4 / together;
  double low = lowest_square(free, tail);
  // Where samples are worth little, of means below a half: P(at most x events, of half on average) = gamma_q(x + 1, half).
  if (squared_worth < 0.5 * worth) low = free > 0 ? std::min(low, lowest_events(free, tail)) : 0;
  return {square / worth, low / half, std::max(1.0, boost::math::gamma_q_inv(half, tail)) / half};
}

}  // namespace sysid
