// Curved ridges: a row of normal distributions follows them, and chains whose moves go about it cross them.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "inference/chain/mh.hpp"
#include "inference/chain/ridge.hpp"
#include "inference/interruptions.hpp"
#include "search/descent.hpp"
#include "search/laplace.hpp"

using namespace sysid;
using namespace sysid::testing;
using namespace sysid::metropolis;

namespace {

/// b = a^2 to a hundredth, a from a standard normal distribution.
TestTarget banana() {
  return TestTarget({"a", "b"}, {{Prior::normal, 0, 1}, {Prior::normal, 0, 100}}, 1, 0,
                    [](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = (w[1] - w[0] * w[0]) / 0.01; });
}

RidgeRow ridge_row_from(Target const& target, std::vector<double> const& declared) {
  Objective const objective = make_objective(target, ObjectiveKind::posterior, 1, 0);
  LaneArray values(target.dimension(), 1), theta(target.dimension(), 1);
  for (int p = 0; p < values.rows(); ++p) values(p, 0) = declared[static_cast<std::size_t>(p)];
  target.unconstrain(values, theta);
  Ledger ledger;
  Eigen::VectorXd const start = column(theta, 0);
  Mode const mode = laplace_mode(objective, start, slope_at(objective, start, ledger).curvature, ledger);
  return along_ridge(objective, mode, ledger);
}

std::vector<Independence::Component> ridge_from(Target const& target, std::vector<double> const& declared) {
  RidgeRow const row = ridge_row_from(target, declared);
  CHECK(row.complete);
  return row.components;
}

/// Draws of a mixture, weighed by the density: the share of independent draws that they are worth, and the sd of the first value.
struct Weighed {
  double worth = 0, sd = 0;
};
Weighed weigh(Target const& target, std::vector<Independence::Component> const& components) {
  constexpr int count = 4000;
  Independence const mixture(components);
  std::vector<StreamKey> keys;
  for (std::uint64_t n = 0; n < count; ++n) keys.push_back({3, Purpose::test, n, 0});
  LaneArray theta(target.dimension(), count), declared(target.dimension(), count);
  mixture.draw(keys, theta);
  target.constrain(theta, declared);
  std::vector<double> log_q(count), log_prior(count), log_likelihood(count);
  Ledger ledger;
  mixture.log_density(theta, log_q);
  target.log_prior(theta, log_prior);
  target.log_likelihood(theta, log_likelihood, ledger);
  double highest = -infinity, sum = 0, squares = 0, mean = 0, second = 0;
  for (std::size_t n = 0; n < count; ++n) highest = std::max(highest, log_q[n] = log_prior[n] + log_likelihood[n] - log_q[n]);
  for (std::size_t n = 0; n < count; ++n) {
    double const weight = std::exp(log_q[n] - highest), value = declared(0, static_cast<int>(n));
    if (weight == 0) continue;
    sum += weight;
    squares += weight * weight;
    mean += weight * value;
    second += weight * value * value;
  }
  return {sum * sum / squares / count, std::sqrt(second / sum - mean * mean / (sum * sum))};
}

}  // namespace

TEST_CASE("a row of normal distributions along a curved ridge is worth many independent draws") {
  TestTarget const parabola = banana();
  auto const along = ridge_from(parabola, {0.3, 0.09});
  CHECK(along.size() > 10);
  Weighed const curved = weigh(parabola, along);
  MESSAGE(along.size() << " components, worth " << curved.worth);
  CHECK(curved.worth > 0.4);
  CHECK(curved.sd == doctest::Approx(1).epsilon(0.05));

  // The product of two uniform factors is known: log-uniform along the ridge, from one end of the prior to the other.
  TestTarget const product({"a", "b"}, {{Prior::log_uniform, 0.1, 10}, {Prior::log_uniform, 0.1, 10}}, 1, 0,
                           [](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = (w[0] * w[1] - 1) / 0.001; });
  Weighed const ends = weigh(product, ridge_from(product, {1, 1}));
  MESSAGE("worth " << ends.worth);
  CHECK(ends.worth > 0.4);
  CHECK(ends.sd == doctest::Approx(2.497).epsilon(0.06));
}

TEST_CASE("a straight ridge is one row, worth what a normal distribution is") {
  TestTarget const straight({"a", "b"}, {{Prior::normal, 0, 1}, {Prior::normal, 0, 100}}, 1, 0,
                            [](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = (w[1] - w[0]) / 0.01; });
  Weighed const all = weigh(straight, ridge_from(straight, {0, 0}));
  CHECK(all.worth > 0.5);
  CHECK(all.sd == doctest::Approx(1).epsilon(0.05));
}

TEST_CASE("the worth of a mixture's draws falls with its distance from the density") {
  TestTarget const normal({"a", "b"}, {{Prior::normal, 0, 1}, {Prior::normal, 0, 1}}, 1, 0,
                          [](std::vector<double> const&, std::vector<double>& rows) { rows[0] = 0; });
  Objective const objective = make_objective(normal, ObjectiveKind::posterior, 1, 0);
  Ledger ledger;
  auto const worth = [&](double mean, double variance) {
    Independence const mixture({{1, Eigen::Vector2d(mean, 0), variance * Eigen::Matrix2d::Identity()}});
    return worth_of_draws(objective, mixture, 1, ledger);
  };
  CHECK(worth(0, 1) > 0.85);
  CHECK(worth(0, 4) < 0.6);
  CHECK(worth(0, 4) > 0.2);
  CHECK(worth(6, 1) < 0.05);
  CHECK(ledger.solves() == 4 * 512);
}

TEST_CASE("chains cross a curved ridge that walks do not cross, and go on from where they were stopped, to the same bytes") {
  TestTarget const target = banana();
  auto const settings_of = [](char const* proposal) {
    Settings settings(mh::settings());
    settings.set("samples", std::int64_t{6000});
    settings.set("burn_in", std::int64_t{2000});
    settings.set("proposal", std::string(proposal));
    return settings;
  };
  Unbroken const whole = unbroken(mh::run, target, settings_of("adaptive"));
  REQUIRE(whole.last.at("independence").at("ridge").at(1).get<bool>());  // the mixture in use is one along the ridge
  Bench walking(interrupted_seed);
  auto const found = summarise(whole.result), walk = summarise(mh::run(target, settings_of("walk"), walking.context));
  MESSAGE("effective draws of a: " << found[0].ess_bulk << " and " << walk[0].ess_bulk);
  CHECK(found[0].rhat < 1.01);
  CHECK(found[0].ess_bulk > 5 * walk[0].ess_bulk);
  CHECK(std::fabs(found[0].mean) < 4 * found[0].mcse_mean);
  CHECK(found[0].sd == doctest::Approx(1).epsilon(0.06));
  int const end = whole.questions;
  check_stops(mh::run, target, settings_of("adaptive"), whole, {end - 1, end * 3 / 4, end / 2, end / 4, end / 8});
}

TEST_CASE("a ridge that is hundreds of its widths long is followed to its ends, and one that is longer is called incomplete") {
  // b = 30 a^2 within `width`, a ~ N(0, 1): the mean of b is 30, its variance 2 * 30^2.
  auto const banana = [](double width) {
    return TestTarget(
        {"a", "b"}, {{Prior::normal, 0, 1}, {Prior::normal, 0, 1000}}, 1, 0,
        [width](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = (w[1] - 30 * w[0] * w[0]) / width; });
  };
  TestTarget const followed = banana(0.02);
  RidgeRow const row = ridge_row_from(followed, {0, 0});
  CHECK(row.complete);
  CHECK(row.components.size() > 100);
  double farthest = 0;
  for (auto const& each : row.components) farthest = std::max(farthest, std::abs(each.mean(0)));
  CHECK(farthest > 3.5);
  CHECK_FALSE(ridge_row_from(banana(1e-5), {0, 0}).complete);
  Settings settings(mh::settings());
  settings.set("samples", std::int64_t{12000});
  Bench bench(1);
  FitResult const result = mh::run(followed, settings, bench.context);
  REQUIRE_FALSE(result.failure);
  CHECK(std::abs(result.summaries[1].mean - 30) < 4 * result.summaries[1].mcse_mean);
  CHECK(result.summaries[1].sd == doctest::Approx(30 * std::sqrt(2.0)).epsilon(0.1));
}
