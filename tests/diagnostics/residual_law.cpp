// Residuals of other laws than normal noise of one size, and how rarely white normal residuals are taken for them.
#include "diagnostics/law/residual_law.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/numeric/random.hpp"
#include "relative.hpp"
#include "replications.hpp"

using namespace sysid;

namespace {

constexpr double limit_of_one_channel = 0.001 / 2;

struct Residuals {
  std::vector<double> values, predicted;
};

/// Standard normal along a slow wave of amplitude 1 about `level`.
Residuals white(std::uint64_t seed, int samples, double level) {
  Stream stream({seed, Purpose::test, 0, 0});
  Residuals made;
  for (int i = 0; i < samples; ++i) {
    made.values.push_back(stream.normal());
    made.predicted.push_back(level + std::sin(0.07 * i));
  }
  return made;
}

}  // namespace

TEST_CASE("the p of a kurtosis is that of published tables") {
  // D'Agostino, Belanger and D'Agostino 1990, The American Statistician 44, 316: 62 cholesterol values with b2 = 4.58 have Z
  // = 2.21.
  CHECK(kurtosis_p(4.58, 62) == relative(0.01355, 0.02));
  // The numbers 0 to 19, the example of scipy.stats.kurtosistest: statistic -1.7058104152122062.
  CHECK(kurtosis_p(0.6 * (3 * 400 - 7) / (400 - 1), 20) == doctest::Approx(0.955978).epsilon(1e-5));
}

TEST_CASE("white normal residuals have the law of normal noise but for one record in a thousand") {
  // The limit is reached by chance in 0.05 % of the records for each of the two. A p that is off by a factor of five is found.
  int heavy = 0, grows = 0, records = 0;
  for (int const samples : {30, 60, 200, 1000})
    for (std::uint64_t const seed : counted_from(1, replications(1000, 20000))) {
      Residuals const made = white(seed, samples, seed % 2 == 0 ? 0 : 5);
      ResidualLaw const law = residual_law(made.values, made.predicted);
      heavy += law.heavy(limit_of_one_channel);
      grows += law.grows(limit_of_one_channel);
      ++records;
    }
  MESSAGE("of ", records, " records ", heavy, " have heavy tails and ", grows, " grow");
  double const expected = 0.0005 * records;
  CHECK(heavy <= expected + 4 * std::sqrt(expected));
  CHECK(grows <= expected + 4 * std::sqrt(expected));
}

TEST_CASE("residuals with a memory are not taken for residuals that grow with a slow prediction") {
  // Where neighbours are not looked at, three records in a hundred are.
  int grows = 0;
  for (std::uint64_t const seed : counted_from(1, replications(500, 20000))) {
    Residuals made = white(seed, 60, 5);
    for (std::size_t i = 1; i < made.values.size(); ++i) made.values[i] = 0.8 * made.values[i - 1] + 0.6 * made.values[i];
    grows += residual_law(made.values, made.predicted).grows(limit_of_one_channel);
  }
  CHECK(grows <= replications(2, 20));
}

TEST_CASE("one sample in twenty-five that is far off gives residuals heavy tails") {
  for (std::uint64_t const seed : {1, 2, 3, 4, 5}) {
    Residuals made = white(seed, 200, 0);
    for (std::size_t i = 7; i < made.values.size(); i += 25) made.values[i] *= 25;
    CHECK(residual_law(made.values, made.predicted).heavy(limit_of_one_channel));
  }
}

TEST_CASE("noise in proportion to the signal grows with it, and is not taken for heavy tails alone") {
  for (std::uint64_t const seed : {1, 2, 3, 4, 5}) {
    Residuals made = white(seed, 200, 0);
    for (std::size_t i = 0; i < made.values.size(); ++i) made.values[i] *= 0.1 + std::fabs(made.predicted[i]);
    ResidualLaw const law = residual_law(made.values, made.predicted);
    CHECK(law.grows(limit_of_one_channel));
    CHECK(law.growth > 2);
  }
}

TEST_CASE("in units of a size that grows with the prediction large samples are as the others, and a bad one stays far off") {
  Residuals made = white(1, 3000, 0);
  auto const size = [&](std::size_t i) { return std::sqrt(0.04 + 4 * made.predicted[i] * made.predicted[i]); };
  std::vector<double> const stated = made.values;
  for (std::size_t i = 0; i < made.values.size(); ++i) made.values[i] *= size(i);
  std::size_t const bad[] = {0, 1000};  // where the prediction is 0, and somewhere
  for (std::size_t const place : bad) made.values[place] = 10;
  made.values[7] = std::nan("");
  std::vector<double> const units = in_growing_units(made.values, made.predicted, bad);
  CHECK(std::isnan(units[7]));
  double largest = 0;
  for (std::size_t i = 0; i < units.size(); ++i) {
    if (i == 7 || i == bad[0] || i == bad[1]) continue;
    largest = std::max(largest, std::fabs(units[i]));
    // No larger than in units of its own size, but for the error of the two mean squares, and smaller where the prediction is.
    CHECK(std::fabs(units[i]) < 1.2 * std::fabs(stated[i]) + 1e-12);
  }
  CHECK(largest > 3);
  for (std::size_t const place : bad) CHECK(units[place] > 4);
}

TEST_CASE("residuals that are missing, or too few, tell nothing") {
  Residuals made = white(1, 60, 0);
  for (std::size_t i = 0; i < 35; ++i) made.values[i] = std::nan("");
  made.values[40] = 100;
  ResidualLaw const law = residual_law(made.values, made.predicted);
  CHECK(law.tail_p == 1);
  CHECK(law.growth_p == 1);
}
