// Closed forms, and what distinguishes two functions for one quantity.
#include "core/numeric/statistics.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/numeric/normal_quantile.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/numeric/random.hpp"
#include "core/numeric/tails.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

using Values = std::vector<double>;
constexpr double beyond_all = std::numeric_limits<double>::infinity();

}  // namespace

TEST_CASE("means and variances of a few numbers") {
  Values const x = {1, 2, 4, 9};
  CHECK(mean(x) == 4);
  CHECK(squared_deviations(x, 4) == 38);
  CHECK(sample_variance(x) == doctest::Approx(38. / 3).epsilon(1e-15));
  CHECK(population_variance(x) == 9.5);
  CHECK(corrected_mean(x) == 4);
  CHECK(corrected_variance(x) == doctest::Approx(38. / 3).epsilon(1e-15));
  CHECK(std::isnan(mean(Values{})));
  CHECK(std::isnan(sample_variance(Values{1})));
  CHECK(std::isnan(population_variance(Values{})));
  CHECK(population_variance(Values{1}) == 0);
  CHECK(pooled({{1, 2}, {}, {3}}) == Values{1, 2, 3});
}

TEST_CASE("corrected means and variances hold where sums lose digits") {
  // 0.1 a million times: the sum in order is off in the eleventh digit.
  Values const tenths(1'000'000, 0.1);
  CHECK(corrected_mean(tenths) == 0.1);
  CHECK(corrected_variance(tenths) == 0);
  // Squares of 1 and of 1e-8, half of each: the variance is n / 2 (1 + 1e-8) / (n - 1).
  Values mixed;
  for (int i = 0; i < 100'000; ++i) mixed.insert(mixed.end(), {1, -1, 1e-4, -1e-4});
  double const n = 400'000;
  CHECK(corrected_variance(mixed) == doctest::Approx(n / 2 * (1 + 1e-8) / (n - 1)).epsilon(3e-16));
}

TEST_CASE("quantiles of types 6 and 7") {
  Values const x = {4, 1, 3, 2};  // R: quantile(1:4, p, type = ...)
  Values const sorted = {1, 2, 3, 4};
  CHECK(quantile(x, 0) == 1);
  CHECK(quantile(x, 1) == 4);
  CHECK(quantile(x, 0.1) == doctest::Approx(1.3).epsilon(1e-15));
  CHECK(sorted_quantile(sorted, 0.1) == quantile(x, 0.1));
  Values draws = x;
  CHECK(predictive_quantile(draws, 0.3) == doctest::Approx(1.5).epsilon(1e-15));
  CHECK(predictive_quantile(draws, 0.01) == 1);
  CHECK(predictive_quantile(draws, 0.99) == 4);
  CHECK(std::isnan(quantile({}, 0.5)));
  CHECK(std::isnan(quantile({1, std::nan("")}, 0.5)));
  CHECK(quantile({beyond_all, beyond_all}, 0.5) == beyond_all);  // not beyond_all - beyond_all
}

TEST_CASE("the median lies between the middle two, the upper median is one of them") {
  CHECK(median({4, 1, 3, 2}) == 2.5);
  CHECK(median({9, 1, 3}) == 3);
  CHECK(upper_median({4, 1, 3, 2}) == 3);
  CHECK(upper_median({9, 1, 3}) == 3);
  CHECK(upper_median({beyond_all, 1, beyond_all, 2}) == beyond_all);
}

TEST_CASE("the range is that of the finite values") {
  CHECK(finite_range({}) == std::pair(0.0, 1.0));
  CHECK(finite_range({std::nan(""), 2, -beyond_all, -1}) == std::pair(-1.0, 2.0));
}

TEST_CASE("quantiles of the standard normal invert its cumulative probability") {
  CHECK(standard_normal_quantile(0.95) == doctest::Approx(normal_quantile_95).epsilon(1e-15));
  CHECK(standard_normal_quantile_from_middle(0) == 0);
  for (double const p : {1e-300, 1e-20, 1e-6, 0.05, 0.0749, 0.0751, 0.3, 0.5, 0.7, 0.9249, 0.9251, 0.999}) {
    CAPTURE(p);
    double const z = standard_normal_quantile(p);
    CHECK(std::erfc(-z / std::sqrt(2.0)) / 2 == relative(p, 1e-12));
    CHECK(normal_score(p) == doctest::Approx(z).epsilon(4e-16));
  }
  for (double const q : {-0.49, -0.425, -1e-9, 1e-9, 0.2, 0.4251})
    CHECK(standard_normal_quantile_from_middle(q) == relative(standard_normal_quantile(0.5 + q), 1e-7));
}

TEST_CASE("the tails of several sequences are those of each when it is sorted") {
  constexpr int depth = 5, count = 37;
  Stream stream({9, Purpose::test, 0, 0});
  double smallest[depth][sequences_at_once], largest[depth][sequences_at_once];
  std::fill_n(smallest[0], depth * sequences_at_once, infinity);
  std::fill_n(largest[0], depth * sequences_at_once, -infinity);
  std::vector<std::vector<double>> all(sequences_at_once);
  for (int i = 0; i < count; ++i) {
    double next[sequences_at_once];
    for (int k = 0; k < sequences_at_once; ++k)
      all[static_cast<std::size_t>(k)].push_back(next[k] = std::round(5 * stream.normal()));
    add_to_tails(smallest[0], largest[0], depth, next);
  }
  for (int k = 0; k < sequences_at_once; ++k) {
    std::vector<double>& sorted = all[static_cast<std::size_t>(k)];
    std::sort(sorted.begin(), sorted.end());
    for (int r = 0; r < depth; ++r) {
      CHECK(smallest[r][k] == sorted[static_cast<std::size_t>(r)]);
      CHECK(largest[r][k] == sorted[static_cast<std::size_t>(count - 1 - r)]);
    }
  }
}

TEST_CASE("weights are worth as many equal ones as their squares say") {
  CHECK(effective_number(Values{2, 2, 2, 2}) == 4);
  CHECK(effective_number(Values{5, 0, 0}) == 1);
  CHECK(effective_number(Values{3, 1}) == 1.6);
  CHECK(effective_number(Values{0, 0}) == 0);
  CHECK(effective_number(Values{}) == 0);
}

TEST_CASE("sums and means of exponentials are added without overflow, and those of nothing are 0") {
  double const infinity = std::numeric_limits<double>::infinity();
  CHECK(log_of_sum(1000, 1000) == doctest::Approx(1000 + std::log(2.0)));
  CHECK(log_of_sum(-infinity, -3) == -3);
  CHECK(log_of_sum(-infinity, -infinity) == -infinity);
  std::vector<double> const logs = {-800, -infinity, -800 + std::log(3.0)};
  CHECK(log_of_sum(logs) == doctest::Approx(-800 + std::log(4.0)));
  CHECK(log_of_mean(logs) == doctest::Approx(-800 + std::log(4.0 / 3)));
  CHECK(log_of_sum(std::vector<double>{}) == -infinity);
  CHECK(log_of_mean(std::vector<double>{-infinity, -infinity}) == -infinity);
}
