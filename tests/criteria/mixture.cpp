// Mixtures of draws against closed forms: quantiles, the law of total variance, densities.
#include "criteria/mixture.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/numeric/normal_quantile.hpp"
#include "core/numeric/random.hpp"
#include "core/numeric/statistics.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

std::vector<double> normal_draws(int count, double mean, double sd, std::uint64_t seed) {
  Stream stream({seed, Purpose::test, 0, 0});
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(mean + sd * stream.normal());
  std::ranges::sort(values);
  return values;
}

/// As regular as draws can be: the quantiles at i/(n + 1).
std::vector<double> normal_grid(int count, double mean, double sd) {
  std::vector<double> values;
  for (int i = 1; i <= count; ++i) values.push_back(mean + sd * standard_normal_quantile(i / (count + 1.0)));
  return values;
}

double normal_cumulative(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

}  // namespace

TEST_CASE("the quantiles of a mixture of one are those of type 6") {
  for (int const count : {1, 2, 7, 39, 100, 401}) {
    std::vector<double> values = normal_draws(count, 2, 3, 7);
    MixtureDraws const alone[] = {{1, values}};
    for (double const probability : {0.001, 0.025, 0.2, 0.5, 0.81, 0.975, 0.999}) {
      CAPTURE(count);
      CAPTURE(probability);
      std::vector<double> again = values;
      CHECK(mixture_quantile(alone, probability) == relative(predictive_quantile(again, probability), 1e-12));
    }
  }
}

TEST_CASE("a mixture of two halves of equal draws has the quantiles of either") {
  std::vector<double> const values = normal_draws(60, 0, 1, 3);
  MixtureDraws const alone[] = {{1, values}}, halves[] = {{0.3, values}, {0.7, values}};
  for (double const probability : {0.01, 0.025, 0.5, 0.975})
    CHECK(mixture_quantile(halves, probability) == relative(mixture_quantile(alone, probability), 1e-12));
}

TEST_CASE("the quantile of a mixture of two normals solves the sum of their distributions") {
  std::vector<double> const one = normal_grid(4000, 0, 1), other = normal_grid(1000, 4, 0.5);
  for (double const weight : {0.02, 0.05, 0.3, 0.9}) {
    MixtureDraws const both[] = {{1 - weight, one}, {weight, other}};
    for (double const probability : {0.025, 0.3, 0.975}) {
      CAPTURE(weight);
      CAPTURE(probability);
      double const x = mixture_quantile(both, probability);
      CHECK((1 - weight) * normal_cumulative(x) + weight * normal_cumulative((x - 4) / 0.5) == relative(probability, 1e-3));
    }
  }
}

TEST_CASE("a member with a small weight places the limit that it alone reaches") {
  // Its lower half lies above all draws of the other: with a weight of 0.05 the limit is its median.
  std::vector<double> const most = normal_grid(400, 0, 1), few = normal_grid(400, 100, 1);
  MixtureDraws const both[] = {{0.95, most}, {0.05, few}};
  CHECK(mixture_quantile(both, 0.975) == doctest::Approx(100).epsilon(1e-3));
}

TEST_CASE("equal draws and probabilities beyond the draws have quantiles among the draws") {
  std::vector<double> const steps = {0, 0, 0, 1, 1}, other = {0, 2};
  MixtureDraws const both[] = {{0.5, steps}, {0.5, other}};
  CHECK(mixture_quantile(both, 1e-6) == 0);
  CHECK(mixture_quantile(both, 1 - 1e-6) == 2);
  double last = 0;
  for (double p = 0.01; p < 1; p += 0.01) {
    double const x = mixture_quantile(both, p);
    CHECK(x >= last);
    last = x;
  }
}

TEST_CASE("the parts of the variance are those of a hierarchy of normals") {
  // y | mean ~ N(mean, noise), mean | model ~ N(m, v): all known.
  MemberMoments const members[] = {{0.25, 1, 4, 0.5}, {0.75, 3, 1, 0.1}};
  VarianceSplit const split = split_variance(members);
  CHECK(split.mean == doctest::Approx(2.5));
  CHECK(split.parameter == doctest::Approx(0.25 * 4 + 0.75 * 1));
  CHECK(split.model == doctest::Approx(0.25 * 0.75 * 4));
  CHECK(split.noise == relative(0.25 * 0.5 + 0.75 * 0.1, 1e-12));
  // E y^2 - (E y)^2 of the mixture.
  double const square = 0.25 * (1 + 4 + 0.5) + 0.75 * (9 + 1 + 0.1);
  CHECK(split.total() == doctest::Approx(square - 2.5 * 2.5));
}

TEST_CASE("one model has no part between models") {
  MemberMoments const alone[] = {{1, 7, 2, 0.3}};
  VarianceSplit const split = split_variance(alone);
  CHECK(split.model == 0);
  CHECK(split.parameter == 2);
  CHECK(split.noise == 0.3);
}

TEST_CASE("the parts of pooled draws sum to their sample variance") {
  std::vector<std::vector<double>> const groups = {normal_draws(30, 0, 1, 1), normal_draws(5, 2, 0.3, 2), {}, {4.5}};
  std::vector<double> all;
  for (auto const& group : groups) all.insert(all.end(), group.begin(), group.end());
  VarianceSplit const split = split_pooled(groups);
  CHECK(split.parameter + split.model == doctest::Approx(sample_variance(all)).epsilon(1e-12));
  CHECK(split.model > 0);
  CHECK(split.noise == 0);
}

TEST_CASE("the density of a mixture is the weighed sum, and members without weight count for nothing") {
  double const none = -std::numeric_limits<double>::infinity();
  std::vector<double> const weights = {0.25, 0.75, 0}, densities = {std::log(2.0), std::log(0.4), std::log(1e9)};
  CHECK(log_mixture_density(weights, densities) == relative(std::log(0.25 * 2 + 0.75 * 0.4), 1e-12));
  CHECK(log_mixture_density(weights, std::vector{none, -800.0, 5.0}) == doctest::Approx(std::log(0.75) - 800));
  CHECK(log_mixture_density(weights, std::vector{none, none, 5.0}) == none);
}
