// Simultaneous bands of ranks: exact where all outcomes can be counted, right on average where they are drawn.
#include "diagnostics/calibration/ecdf_bands.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "core/numeric/random.hpp"
#include "core/text/diagnostic.hpp"
#include "relative.hpp"
#include "replications.hpp"

using namespace sysid;

namespace {

// The share of all `values`^n outcomes whose counts stay within the limits.
double counted_within(int n, int values, std::vector<int> const& low, std::vector<int> const& high) {
  int outcomes = 1, inside = 0;
  for (int i = 0; i < n; ++i) outcomes *= values;
  for (int outcome = 0; outcome < outcomes; ++outcome) {
    bool within = true;
    for (int k = 1; k < values; ++k) {
      int below = 0, rest = outcome;
      for (int i = 0; i < n; ++i, rest /= values) below += rest % values < k;
      within = within && below >= low[static_cast<std::size_t>(k - 1)] && below <= high[static_cast<std::size_t>(k - 1)];
    }
    inside += within;
  }
  return static_cast<double>(inside) / outcomes;
}

std::vector<int> uniform_ranks(int n, int values, std::uint64_t number) {
  Stream stream({17, Purpose::test, number, 0});
  std::vector<int> ranks;
  for (int i = 0; i < n; ++i) ranks.push_back(static_cast<int>(stream.below(static_cast<std::uint64_t>(values))));
  return ranks;
}

}  // namespace

TEST_CASE("the probability that counts stay within limits is that of all outcomes counted one by one") {
  CHECK(probability_within(6, 4, {0, 1, 3}, {3, 5, 6}) ==
        doctest::Approx(counted_within(6, 4, {0, 1, 3}, {3, 5, 6})).epsilon(1e-12));
  CHECK(probability_within(5, 5, {0, 1, 2, 3}, {2, 3, 4, 5}) ==
        doctest::Approx(counted_within(5, 5, {0, 1, 2, 3}, {2, 3, 4, 5})).epsilon(1e-12));
  CHECK(probability_within(7, 3, {0, 0}, {7, 7}) == doctest::Approx(1).epsilon(1e-12));
}

TEST_CASE("the band holds its level, and no wider one is needed") {
  for (int const n : {20, 100, 500}) {
    CountBands const band = ecdf_bands(n, 100, 0.95);
    double const level = probability_within(n, 100, band.low, band.high);
    CAPTURE(n);
    CHECK(level >= 0.95);
    CHECK(level < 0.975);  // counts are whole numbers
    // Below all of 1 - 0.95 and above its part by Bonferroni.
    CHECK(band.pointwise < 0.05);
    CHECK(band.pointwise > 0.05 / 99);
    int outside = 0;
    constexpr int draws = 1000;
    for (std::uint64_t r = 0; r < draws; ++r) {
      std::vector<int> const ranks = uniform_ranks(n, 100, r);
      std::vector<int> counts(100, 0);
      for (int const rank : ranks) ++counts[static_cast<std::size_t>(rank)];
      bool within = true;
      for (std::size_t k = 0, below = 0; k + 1 < 100; ++k) {
        below += static_cast<std::size_t>(counts[k]);
        within = within && static_cast<int>(below) >= band.low[k] && static_cast<int>(below) <= band.high[k];
      }
      outside += !within;
    }
    // Four sds of a binomial count.
    CHECK(std::fabs(outside - draws * (1 - level)) < 4 * std::sqrt(draws * level * (1 - level)));
  }
}

TEST_CASE("the band of 250 draws is that of its definition: binomial quantiles at the level that it states") {
  CountBands const band = ecdf_bands(250, 100, 0.95);
  // In the middle sqrt(250)/2 = 7.9 is the sd of a count; 0.95 all along takes about three of them to either side.
  CHECK(band.low[49] == 250 - band.high[49]);
  CHECK(band.high[49] - 125 > 2.5 * 7.9);
  CHECK(band.high[49] - 125 < 3.2 * 7.9);
  for (std::size_t k = 0; k < 99; ++k) CHECK(band.low[k] == 250 - band.high[98 - k]);
}

TEST_CASE("p values of uniform ranks fall below 0.05 and 0.01 no more often than stated, those of shifted ranks always") {
  int rare = 0, very_rare = 0, chi_rare = 0;
  int const draws = replications(300, 600);
  for (std::uint64_t const r : counted_from(5000, draws)) {
    std::vector<int> const ranks = uniform_ranks(100, 100, r);
    double const p = ecdf_p_value(ranks, 100);
    rare += p < 0.05;
    very_rare += p < 0.01;
    chi_rare += chi_squared_p_value(ranks, 100, 20) < 0.05;
  }
  CHECK(rare <= 0.05 * draws + 3 * std::sqrt(0.05 * draws));
  CHECK(rare >= 0.02 * draws);
  CHECK(very_rare <= 0.01 * draws + 3 * std::sqrt(0.01 * draws));
  CHECK(std::fabs(chi_rare - 0.05 * draws) < 4 * std::sqrt(0.05 * draws));
  std::vector<int> shifted = uniform_ranks(200, 100, 1);
  for (int& rank : shifted) rank = rank * 8 / 10;
  CHECK(ecdf_p_value(shifted, 100) < 1e-4);
  CHECK(chi_squared_p_value(shifted, 100, 20) < 1e-4);
  CHECK(ecdf_p_value({}, 100) == 1);
}

TEST_CASE("the p value of a chi-square statistic is that of its closed form for two degrees of freedom") {
  // Three groups of 10, 20 and 30 ranks: 10 in sum, P = exp(-5).
  std::vector<int> ranks(10, 0);
  ranks.insert(ranks.end(), 20, 1);
  ranks.insert(ranks.end(), 30, 2);
  CHECK(chi_squared_p_value(ranks, 3, 3) == relative(std::exp(-5.0), 1e-12));
}

TEST_CASE("groups of ranks divide them evenly and hold five each") {
  CHECK(rank_bins(500, 100) == 20);
  CHECK(rank_bins(60, 100) == 5);
  CHECK(rank_bins(20, 100) == 2);
  CHECK(rank_bins(10, 100) == 2);
}
