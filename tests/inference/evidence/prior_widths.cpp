// The evidence under other widths of the priors, against a closed form: the mean of normal samples under a normal prior.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/numeric/random.hpp"
#include "inference/evidence/prior_widths.hpp"

using namespace sysid;

namespace {

constexpr double prior_sd = 2, noise_sd = 0.5, observed = 1.3;
constexpr int chain_count = 4, per_chain = 250;

PriorInfo prior(std::string name, std::string distribution, std::vector<double> arguments) {
  PriorInfo result;
  result.name = std::move(name);
  result.numbers = PriorNumbers{std::move(distribution), std::move(arguments), {}, {}, 1};
  return result;
}

/// log p(y) of one sample about a mean with a normal prior of that sd.
double log_evidence(double sd) {
  double const variance = sd * sd + noise_sd * noise_sd;
  return -0.5 * std::log(2 * std::numbers::pi * variance) - 0.5 * observed * observed / variance;
}

/// Independent draws of the posterior of that mean, and of one more parameter that the data say nothing about, uniform on 0 to 1.
Draws posterior(std::uint64_t seed) {
  double const precision = 1 / (prior_sd * prior_sd) + 1 / (noise_sd * noise_sd);
  Draws draws{{"mean", "free"}, {"", ""}, {}, 2};
  Stream stream({seed, Purpose::test, 0, 0});
  for (int c = 0; c < chain_count; ++c) {
    Chain& chain = draws.chains.emplace_back();
    for (int d = 0; d < per_chain; ++d)
      chain.values.push_back(
          {observed / (noise_sd * noise_sd) / precision + stream.normal() / std::sqrt(precision), stream.uniform()});
  }
  return draws;
}

PriorWidth const& at(std::vector<PriorWidth> const& effects, std::string const& name, double factor) {
  for (PriorWidth const& each : effects)
    if (each.parameter == name && each.factor == factor) return each;
  FAIL("no effect of " << name);
  return effects.front();
}

}  // namespace

TEST_CASE("the evidence under a prior of another width is that of the closed form, within an error that is calibrated") {
  std::vector<PriorInfo> const priors = {prior("mean", "normal", {0, prior_sd})};
  constexpr int records = 300;
  for (double const factor : {0.5, 2.0, 4.0}) {
    CAPTURE(factor);
    double const truth = log_evidence(factor * prior_sd) - log_evidence(prior_sd);
    double square = 0;
    for (std::uint64_t seed = 1; seed <= records; ++seed) {
      PriorWidth const effect = at(prior_widths(priors, posterior(seed)), "mean", factor);
      REQUIRE(effect.change);
      CHECK(std::fabs(*effect.change - truth) < 5 * effect.error);
      square += (*effect.change - truth) * (*effect.change - truth) / (effect.error * effect.error);
    }
    CHECK(std::sqrt(square / records) > 0.85);
    CHECK(std::sqrt(square / records) < 1.15);
  }
}

TEST_CASE("all priors together change the evidence by the change of each where the posterior has them independent") {
  std::vector<PriorInfo> const priors = {prior("mean", "normal", {0, prior_sd}), prior("free", "normal", {0.5, 1})};
  auto const effects = prior_widths(priors, posterior(1));
  CHECK(effects.size() == 12);
  PriorWidth const all = at(effects, "", 2);
  CHECK(*all.change == doctest::Approx(*at(effects, "mean", 2).change + *at(effects, "free", 2).change).epsilon(3 * all.error));
}

TEST_CASE("a uniform prior twice as wide costs log 2 exactly, unless the posterior ends at its bound") {
  auto const effects = prior_widths({prior("mean", "uniform", {-10, 10}), prior("free", "uniform", {0, 1})}, posterior(1));
  CHECK(*at(effects, "mean", 2).change == doctest::Approx(-std::log(2.0)));
  CHECK(at(effects, "mean", 2).error < 1e-12);
  CHECK(*at(effects, "mean", 0.5).change == doctest::Approx(std::log(2.0)));
  CHECK(*at(effects, "mean", 0.25).change == doctest::Approx(std::log(4.0)).epsilon(0.02));  // a few draws lie beyond 2.5
  CHECK_FALSE(at(effects, "free", 2).change);                                                // what lies beyond 1 is not known
  CHECK_FALSE(at(effects, "", 2).change);
  CHECK(*at(effects, "free", 0.5).change == doctest::Approx(0).epsilon(0.2));
}

TEST_CASE("a prior that the data do not narrow is not widened by ratios without a variance") {
  // The posterior is the prior, so that the true change is 0.
  constexpr int records = 200;
  std::vector<PriorInfo> const priors = {prior("mean", "normal", {0, 1})};
  for (double const factor : {2.0, 4.0}) {
    CAPTURE(factor);
    int known = 0;
    for (std::uint64_t seed = 1; seed <= records; ++seed) {
      Draws draws{{"mean"}, {""}, {}, 1};
      Stream stream({seed, Purpose::test, 0, 1});
      for (int c = 0; c < chain_count; ++c) {
        draws.chains.emplace_back();
        for (int d = 0; d < per_chain; ++d) draws.chains.back().values.push_back({stream.normal()});
      }
      auto const effects = prior_widths(priors, draws);
      known += at(effects, "mean", factor).change ? 1 : 0;
      REQUIRE(at(effects, "mean", 0.5).change);
      CHECK(std::fabs(*at(effects, "mean", 0.5).change) < 5 * at(effects, "mean", 0.5).error);
    }
    CHECK(known < 0.15 * records);
  }
}

TEST_CASE("a prior in whose tail the posterior lies is not narrowed by a few draws") {
  auto const effects = prior_widths({prior("mean", "normal", {-20, 4})}, posterior(1));
  CHECK_FALSE(at(effects, "mean", 0.25).change);
  CHECK(at(effects, "mean", 2).change);
}

TEST_CASE("a prior without numbers or without a width has no entry, and a single draw none") {
  PriorInfo hierarchical;
  hierarchical.name = "mean";
  CHECK(prior_widths({hierarchical, prior("free", "flat", {})}, posterior(1)).empty());
  Draws one = posterior(1);
  one.chains = {Chain{{{1.0, 0.5}}, {}, {}, {}, {}}};
  CHECK(prior_widths({prior("mean", "normal", {0, 2})}, one).empty());
}
