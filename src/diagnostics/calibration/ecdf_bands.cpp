// The recursion along the counts, and the search for the limits.
#include "diagnostics/calibration/ecdf_bands.hpp"

#include <algorithm>
#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>

#include "core/numeric/elementary.hpp"

namespace sysid {
namespace {

/// P(X <= m), X ~ binomial(n, p), 0 < p < 1.
double at_most(int m, int n, double p) {
  if (m < 0) return 0;
  if (m >= n) return 1;
  return boost::math::ibetac(m + 1.0, static_cast<double>(n - m), p);
}

/// P(X >= m).
double at_least(int m, int n, double p) {
  if (m <= 0) return 1;
  if (m > n) return 0;
  return boost::math::ibeta(static_cast<double>(m), n - m + 1.0, p);
}

/// Twice the smaller tail that a count lies in: what gamma must be for it to be left out.
double rarity(int m, int n, double p) { return std::min(1.0, 2 * std::min(at_most(m, n, p), at_least(m, n, p))); }

// Counts that mirror each other are as rare, but for rounding.
constexpr double rounding = 1e-9;

/// The counts whose rarity is above gamma.
CountBands bands_of(int n, int values, double gamma) {
  CountBands bands{{}, {}, gamma};
  for (int k = 1; k < values; ++k) {
    double const p = static_cast<double>(k) / values;
    int const middle = static_cast<int>(std::lround(n * p));
    auto const inside = [&](int m) { return rarity(m, n, p) > gamma * (1 + rounding); };
    // Rarity falls to either side of the middle.
    int low = 0, high = middle;
    while (low < high) {
      int const m = (low + high) / 2;
      if (inside(m))
        high = m;
      else
        low = m + 1;
    }
    bands.low.push_back(low);
    low = middle, high = n;
    while (low < high) {
      int const m = (low + high + 1) / 2;
      if (inside(m))
        low = m;
      else
        high = m - 1;
    }
    bands.high.push_back(low);
  }
  return bands;
}

/// log j! for j = 0 .. n.
std::vector<double> log_factorials(int n) {
  std::vector<double> all(1, 0.0);
  for (int j = 1; j <= n; ++j) all.push_back(all.back() + elementary::log(static_cast<double>(j)));
  return all;
}

}  // namespace

double probability_within(int n, int values, std::vector<int> const& low, std::vector<int> const& high) {
  std::vector<double> const log_factorial = log_factorials(n);
  auto const choose = [&](int of, int j) {
    return log_factorial[static_cast<std::size_t>(of)] - log_factorial[static_cast<std::size_t>(j)] -
           log_factorial[static_cast<std::size_t>(of - j)];
  };
  int first = 0;  // count of probability[0]
  std::vector<double> probability(1, 1.0);
  for (int k = 0; k + 1 < values; ++k) {
    int const from = low[static_cast<std::size_t>(k)], to = high[static_cast<std::size_t>(k)];
    double const p = 1.0 / (values - k), log_p = elementary::log(p), log_q = elementary::log1p(-p);
    std::vector<double> next(static_cast<std::size_t>(std::max(0, to - from + 1)), 0.0);
    for (std::size_t i = 0; i < probability.size(); ++i) {
      int const m = first + static_cast<int>(i), left = n - m;
      for (int to_count = std::max(from, m); to_count <= to; ++to_count) {
        int const more = to_count - m;
        next[static_cast<std::size_t>(to_count - from)] +=
            probability[i] * elementary::exp(choose(left, more) + more * log_p + (left - more) * log_q);
      }
    }
    probability = std::move(next);
    first = from;
  }
  double sum = 0;
  for (double const each : probability) sum += each;
  return sum;
}

CountBands ecdf_bands(int n, int values, double level) {
  // The level falls as gamma rises, in steps: the largest gamma that keeps it.
  double low = elementary::log(1e-9), high = elementary::log(1 - level);
  for (int i = 0; i < 30; ++i) {
    double const middle = 0.5 * (low + high);
    CountBands const tried = bands_of(n, values, elementary::exp(middle));
    (probability_within(n, values, tried.low, tried.high) >= level ? low : high) = middle;
  }
  return bands_of(n, values, elementary::exp(low));
}

double ecdf_p_value(std::span<int const> ranks, int values) {
  if (ranks.empty()) return 1;
  auto const n = static_cast<int>(ranks.size());
  std::vector<int> counts(static_cast<std::size_t>(values), 0);
  for (int const rank : ranks) ++counts[static_cast<std::size_t>(rank)];
  double rarest = 1;
  int below = 0;
  for (int k = 1; k < values; ++k) {
    below += counts[static_cast<std::size_t>(k - 1)];
    rarest = std::min(rarest, rarity(below, n, static_cast<double>(k) / values));
  }
  CountBands const inside = bands_of(n, values, rarest);
  return std::clamp(1 - probability_within(n, values, inside.low, inside.high), 0.0, 1.0);
}

double chi_squared_p_value(std::span<int const> ranks, int values, int bins) {
  if (ranks.empty()) return 1;
  std::vector<double> counts(static_cast<std::size_t>(bins), 0);
  for (int const rank : ranks)
    ++counts[static_cast<std::size_t>(rank) * static_cast<std::size_t>(bins) / static_cast<std::size_t>(values)];
  double const expected = static_cast<double>(ranks.size()) / bins;
  double sum = 0;
  for (double const count : counts) sum += (count - expected) * (count - expected) / expected;
  return boost::math::gamma_q(0.5 * (bins - 1), 0.5 * sum);
}

int rank_bins(int n, int values) {
  constexpr int most = 20, in_each = 10;  // fewer, and its tail is too heavy for p-values of a thousandth
  for (int bins = most; bins > 2; --bins)
    if (values % bins == 0 && n >= bins * in_each) return bins;
  return 2;
}

}  // namespace sysid
