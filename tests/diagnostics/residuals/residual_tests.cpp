// Residual tests: each fires on the fault it is for and stays silent on noise.
#include "diagnostics/residuals/residual_tests.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/numeric/random.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

std::vector<double> noise(std::size_t n, std::uint64_t index, double sd = 1) {
  Stream stream({3, Purpose::test, index, 0});
  std::vector<double> e(n);
  for (double& v : e) v = sd * stream.normal();
  return e;
}

std::vector<double> coloured(std::size_t n, std::uint64_t index, double rho) {
  std::vector<double> e = noise(n, index);
  for (std::size_t t = 1; t < n; ++t) e[t] += rho * e[t - 1];
  return e;
}

/// Every seventh sample missing, and a hole.
std::vector<double> with_gaps(std::vector<double> e) {
  for (std::size_t t = 0; t < e.size(); t += 7) e[t] = missing;
  for (std::size_t t = 100; t < 130 && t < e.size(); ++t) e[t] = missing;
  return e;
}

}  // namespace

TEST_CASE("white residuals pass the whiteness test as often as its level says") {
  int fired = 0, outside = 0, lags = 0, small = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    CorrelationTest const test = whiteness(seed % 2 ? with_gaps(noise(500, seed)) : noise(500, seed));
    fired += test.fires();
    small += test.p_value < 0.05;
    outside += test.outside;
    lags += static_cast<int>(test.correlation.size());
  }
  CHECK(fired <= 6);  // at n = 500 the level 0.1 % is 0.3 % in truth: 1.2 expected, P(more than 6) = 3e-4
  CHECK(small == doctest::Approx(20).epsilon(0.7));  // binomial, sd 4.4: within 3.2 sd
  CHECK(static_cast<double>(outside) / lags == relative(0.01, 0.3));
}

TEST_CASE("coloured residuals and an offset fail the whiteness test, gaps or not") {
  CHECK(whiteness(coloured(500, 1, 0.3)).fires());
  CHECK(whiteness(with_gaps(coloured(500, 1, 0.3))).fires());
  std::vector<double> offset = noise(500, 2);
  for (double& v : offset) v += 0.3;
  CHECK(whiteness(offset).fires());
  CorrelationTest const test = whiteness(coloured(2000, 1, 0.5));
  // A moving average 1 + 0.5 z^-1 has correlation 0.5/1.25 at lag 1 and none beyond; standard error about 1/sqrt(2000).
  CHECK(test.first_lag == 1);
  CHECK(std::fabs(test.correlation[0] - 0.4) < 4 / std::sqrt(2000.0));
  CHECK(std::fabs(test.correlation[4]) < 4 / std::sqrt(2000.0));
}

TEST_CASE("input that the model has used up does not show in the residuals, even when the input is coloured") {
  int fired = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    std::vector<double> const u = coloured(500, 1000 + seed, 0.9);
    fired += input_correlation(seed % 2 ? with_gaps(noise(500, seed)) : noise(500, seed), u).fires();
  }
  CHECK(fired <= 3);  // at most 0.3 expected
}

TEST_CASE("input that leaks into the residuals is found at its lag") {
  std::vector<double> const u = noise(500, 50);
  std::vector<double> e = noise(500, 51);
  for (std::size_t t = 3; t < e.size(); ++t) e[t] += 0.3 * u[t - 3];
  CorrelationTest const test = input_correlation(e, u);
  CHECK(test.fires());
  CHECK(test.correlation[3] > test.bound[3]);
  // corr = 0.3 / sqrt(1.09); the standard error is about 1/sqrt(500).
  CHECK(std::fabs(test.correlation[3] - 0.3 / std::sqrt(1.09)) < 4 / std::sqrt(500.0));
  CHECK(input_correlation(with_gaps(e), u).fires());
}

TEST_CASE("future input, which no cause can read, is not tested for") {
  std::vector<double> const u = noise(500, 60);
  std::vector<double> e = noise(500, 61);
  for (std::size_t t = 0; t + 5 < e.size(); ++t) e[t] += 0.5 * u[t + 5];
  CHECK_FALSE(input_correlation(e, u).fires());
}

TEST_CASE("a trend of few samples is seen where their lags are too few") {
  std::vector<double> falling;
  for (int i = 0; i < 11; ++i) falling.push_back(5 - i);
  CHECK_FALSE(whiteness(falling).fires());
  CHECK(trend_p_value(falling) == relative(2.6236149e-5, 1e-7));  // S = -55, z = 54/sqrt(165)
  falling[4] = missing;
  CHECK(trend_p_value(falling) < 1e-3);
  int fired = 0;
  for (std::uint64_t key = 1; key <= 2000; ++key) fired += trend_p_value(noise(11, key)) < 0.01 ? 1 : 0;
  CHECK(fired < 40);
  CHECK(trend_p_value(std::vector<double>{1, 2, 3, 4}) == 1);
  CHECK(trend_p_value(std::vector<double>(50, 0.0)) == 1);
}

TEST_CASE("records too short or constant are not judged") {
  CHECK_FALSE(whiteness({}).fires());
  CHECK_FALSE(whiteness(std::vector<double>{1, 1, 1}).fires());
  CHECK_FALSE(whiteness(std::vector<double>(50, 0.0)).fires());
  CHECK_FALSE(whiteness(std::vector<double>(50, missing)).fires());
  CHECK_FALSE(input_correlation(noise(50, 1), std::vector<double>(50, 2.0)).fires());
  CHECK(input_correlation(noise(60, 1), std::vector<double>(60, 0.1)).correlation.empty());  // the mean of these is not 0.1
  CHECK(input_correlation(std::vector<double>(60, 0.1), noise(60, 1)).correlation.empty());
}

TEST_CASE("the normalised mean square error is that of (8.18)") {
  std::vector<double> const y = {1, 2, 3, 4}, exact = y, mean(4, 2.5), off = {1, 2, 3, 5};
  CHECK(nmse(y, exact) == 0);
  CHECK(nmse(y, mean) == doctest::Approx(100).epsilon(1e-14));
  CHECK(nmse(y, off) == doctest::Approx(100 * 1.0 / 5.0).epsilon(1e-14));  // N var y = 5
  CHECK(nmse(std::vector<double>{1, missing, 3}, std::vector<double>{1, 9, 2}) == doctest::Approx(100 * 1.0 / 2.0).epsilon(1e-14));
  CHECK(std::isnan(nmse(std::vector<double>{2, 2}, std::vector<double>{1, 2})));
  CHECK(std::isnan(nmse({}, {})));
  CHECK(std::isnan(nmse(std::vector<double>(60, 0.1), std::vector<double>(60, 0.2))));  // the mean of these is not 0.1
}

TEST_CASE("where the noise multiplies the error is that of logarithms, of what has one") {
  std::vector<double> const y = {1, std::exp(1), std::exp(2), std::exp(3)}, off = {1, std::exp(1), std::exp(2), std::exp(4)};
  CHECK(nmse_of_logarithms(y, off) == doctest::Approx(20).epsilon(1e-12));
  CHECK(nmse_of_logarithms(std::vector<double>{missing, 1, 0, std::exp(2)}, std::vector<double>{1, 1, 1, std::exp(1)}) ==
        doctest::Approx(50).epsilon(1e-12));
  CHECK(std::isnan(nmse_of_logarithms(std::vector<double>{1, 2}, std::vector<double>{1, 0})));
}

TEST_CASE("residuals of the stated size pass the chi-squared test, others do not") {
  CHECK_FALSE(chi_squared(noise(500, 70)).fires());
  CHECK_FALSE(chi_squared(with_gaps(noise(500, 71))).fires());
  CHECK(chi_squared(noise(500, 70, 1.3)).fires());
  CHECK(chi_squared(noise(500, 70, 0.7)).fires());
  ChiSquaredTest const test = chi_squared(noise(1000, 72));
  // Wilson and Hilferty: chi^2(n)/n = (1 - 2/(9n) + z sqrt(2/(9n)))^3 with z = 3.2905 for 99.95 %.
  double const a = 2.0 / 9000;
  CHECK(test.high == doctest::Approx(std::pow(1 - a + 3.290526731 * std::sqrt(a), 3)).epsilon(1e-4));
  CHECK(test.low == doctest::Approx(std::pow(1 - a - 3.290526731 * std::sqrt(a), 3)).epsilon(1e-4));
  CHECK_FALSE(chi_squared({}).fires());
}

TEST_CASE("of the sizes of many series one is found wrong in a thousand runs, not in a thousand series") {
  constexpr int runs = 1000, together = 20;
  int wrong = 0;
  for (unsigned run = 0; run < runs; ++run) {
    bool fires = false;
    for (unsigned k = 0; k < together; ++k)
      fires = fires || chi_squared(noise(100, 1000 + together * run + k), 0, together).fires();
    wrong += fires ? 1 : 0;
  }
  CHECK(wrong <= 5);  // one is expected, and 20 of series that know nothing of each other
  CHECK(chi_squared(noise(500, 70, 1.3), 0, together).fires());
}

// n samples of p coefficients by least squares leave chi^2(n - p), whatever the coefficients are.
TEST_CASE("what fitted parameters take from few residuals is no sign of a noise that is too large") {
  constexpr unsigned runs = 2000;
  constexpr int samples = 6, fitted = 3;
  int wrong = 0, without = 0;
  for (unsigned run = 0; run < runs; ++run) {
    std::vector<double> left = noise(samples, 40000 + run);
    // Of two samples each the mean, as three parameters would.
    for (std::size_t i = 0; i < samples; i += 2) {
      double const mean = (left[i] + left[i + 1]) / 2;
      left[i] -= mean, left[i + 1] -= mean;
    }
    wrong += chi_squared(left, 0, 1, fitted).fires() ? 1 : 0;
    without += chi_squared(left).fires() ? 1 : 0;
  }
  CHECK(wrong <= 5);  // one is expected
  CHECK(without > 40);
  CHECK(chi_squared(noise(40, 7, 0.3), 0, 1, fitted).fires());
  CHECK_FALSE(chi_squared(std::vector<double>{1e-9, 1e-9}, 0, 1, 3).fires());  // nothing is free
}

namespace {

/// How many of these records of Poisson counts have the size of their noise. [runs] below, above.
std::pair<int, int> counts_off(std::vector<double> const& means, unsigned runs, double scatter = 1) {
  std::pair<int, int> off;
  std::vector<double> degrees;
  for (double const mean : means) degrees.push_back(2 / (2 + 1 / mean));
  for (unsigned run = 0; run < runs; ++run) {
    Stream stream({4, Purpose::test, run, 0});
    std::vector<double> sized;
    for (double const mean : means) {
      double left = stream.uniform(), probability = std::exp(-mean), count = 0;
      while (left > probability && probability > 0) left -= probability, probability *= mean / ++count;
      sized.push_back(scatter * (count - mean) / std::sqrt(mean));
    }
    ChiSquaredTest const test = chi_squared_of_counts(sized, degrees);
    off.first += test.fires() && test.per_sample < test.low;
    off.second += test.fires() && test.per_sample > test.high;
  }
  return off;
}

}  // namespace

// Levels by simulations of 50 000 records with numpy: below 2.6e-4, 2e-5, 0, above 1.2e-3, 1.5e-3, 1.6e-4 of the three.
TEST_CASE("counts whose means fall to nothing pass the chi-squared test, others of the same means do not") {
  std::vector<double> decay, peak, rare_events(300, 0.01);
  for (int i = 0; i < 101; ++i) decay.push_back(300 * std::exp(-i / 3.0));
  for (int i = 0; i < 401; ++i) peak.push_back(3 * std::exp(-(i - 200.0) * (i - 200.0) / 56.5) + 1e-300);
  for (auto const& means : {decay, peak, rare_events}) {
    auto const [low, high] = counts_off(means, 1000);
    CHECK(low <= 4);
    CHECK(high <= 7);
  }
  CHECK(counts_off(decay, 100, 3).second > 95);
  CHECK(counts_off(decay, 100, 0.3).first > 95);
}

TEST_CASE("counts of one mean are tested with the degrees of freedom of their excess kurtosis") {
  std::vector<double> const sized = noise(100, 7), degrees(100, 2 / (2 + 1 / 4.0));
  ChiSquaredTest const test = chi_squared_of_counts(sized, degrees, 3), same = chi_squared(sized, 1 / 4.0, 3);
  CHECK(test.per_sample == doctest::Approx(same.per_sample).epsilon(1e-12));
  CHECK(test.low == doctest::Approx(same.low).epsilon(1e-9));
  CHECK(test.high == doctest::Approx(same.high).epsilon(1e-9));
  // Of means that are next to nothing, and of none at all.
  CHECK_FALSE(chi_squared_of_counts(std::vector<double>(9, -1e-150), std::vector<double>(9, 2e-300)).fires());
  CHECK_FALSE(chi_squared_of_counts(std::vector<double>(9, missing), std::vector<double>(9, 0.0)).fires());
  // A count where hardly any was expected.
  CHECK(chi_squared_of_counts(std::vector<double>{1e20, 0.3, -0.2}, std::vector<double>{2e-40, 1, 1}).per_sample ==
        doctest::Approx((2 + 0.09 + 0.04) / 2).epsilon(1e-12));
}

TEST_CASE("of many white series one is found correlated in a thousand runs, weak correlation of many is seen") {
  constexpr int runs = 400, together = 50;
  auto const found = [](unsigned run, double coefficient) {
    std::vector<CorrelationTest> tests;
    std::vector<double> p_values;
    for (unsigned k = 0; k < together; ++k) {
      tests.push_back(whiteness(coloured(100, 50000 + together * run + k, coefficient)));
      p_values.push_back(tests.back().tail_p_value);
    }
    double const limit = limit_together(p_values);
    return std::count_if(tests.begin(), tests.end(), [&](CorrelationTest const& each) { return each.fires(limit); });
  };
  int wrong = 0;
  for (unsigned run = 0; run < runs; ++run) wrong += found(run, 0) > 0 ? 1 : 0;
  CHECK(wrong <= 4);          // 0.4 expected of exact p values, 20 of series that know nothing of each other
  CHECK(found(0, 0.5) > 10);  // half of them below 0.001, few below a fiftieth of that
}

TEST_CASE("the limit of series that are tested together") {
  CHECK(limit_together({}) == rare);
  CHECK(limit_together(std::vector{0.5, 0.2}) == rare);
  CHECK(limit_together(std::vector{1e-4}) == rare);
  std::vector<double> p_values(50, 0.5);
  p_values[7] = 1e-4;
  CHECK(limit_together(p_values) == rare / 50);
  p_values[8] = 1e-4;  // two of 50: 1.2 runs of a thousand
  CHECK(limit_together(p_values) == rare / 50);
  p_values[9] = 1e-4;
  CHECK(limit_together(p_values) == rare);
}
