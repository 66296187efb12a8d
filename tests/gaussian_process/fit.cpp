// Optima in boxes, from several starts, and what is said of them.
#include "gaussian_process/fit.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "core/numeric/not_finite.hpp"
#include "gaussian_process/dense.hpp"
#include "gaussian_process/made.hpp"
#include "gaussian_process/maximise.hpp"
#include "gaussian_process/state_space.hpp"
#include "relative.hpp"

using namespace sysid;
using namespace sysid::gaussian_process;

namespace {

Likelihood dense(Covariance const& covariance, Observations const& observations) {
  return
      [&](Numbers parameters, bool with_gradient) { return dense_marginal(covariance, observations, parameters, with_gradient); };
}

bool has(Concerns const& concerns, Concern::Kind kind) {
  for (Concern const& concern : concerns)
    if (concern.kind == kind) return true;
  return false;
}

/// A likelihood of one parameter, as a function of its logarithm.
Likelihood curve(std::function<double(double)> const& f, std::function<double(double)> const& slope) {
  return [=](Numbers parameters, bool) {
    double const at = std::log(parameters[0]);
    Marginal result;
    result.log_likelihood = f(at);
    result.gradient = Eigen::VectorXd::Constant(1, slope(at));
    if (!std::isfinite(result.log_likelihood)) result.outcome = Outcome::not_positive_definite;
    return result;
  };
}

FitSettings from_starts(int starts) { return {.starts = starts, .key = {.seed = 9, .purpose = Purpose::start}}; }

/// The record for which scikit-learn's optimum stands below: 200 points of two inputs, noise from a linear congruential generator.
Observations recorded(int count) {
  Observations o;
  o.inputs.resize(count, 2);
  o.values.resize(count);
  std::uint64_t state = 12345;
  for (int i = 1; i <= count; ++i) {
    double whole = 0, noise = -6;
    double const x = 10 * std::modf(i * 0.7548776662466927, &whole), z = 10 * std::modf(i * 0.5698402909980532, &whole);
    for (int k = 0; k < 12; ++k) {
      state = (state * 1103515245 + 12345) % 2147483648;
      noise += static_cast<double>(state) / 2147483648.0;
    }
    o.inputs.row(i - 1) << x, z;
    o.values[i - 1] = std::sin(x) + 0.5 * std::cos(0.7 * z) * x / 5 + 0.1 * noise;
  }
  return o;
}

}  // namespace

TEST_CASE("a curved valley with a bound is climbed to its end, deterministically") {
  Density const valley = [](Eigen::VectorXd const& x, Eigen::VectorXd& gradient) {
    double const a = 1 - x[0], b = x[1] - x[0] * x[0];
    gradient[0] = 2 * a + 400 * b * x[0];
    gradient[1] = -200 * b;
    return -(a * a + 100 * b * b);
  };
  Eigen::Vector2d const start(-1.2, 1), low(-2, -2), high(2, 2), cut(0.5, 2);
  Climb const free = maximise(valley, start, low, high, {});
  CHECK(free.converged);
  CHECK((free.at - Eigen::Vector2d(1, 1)).norm() < 1e-3);
  Climb const bounded = maximise(valley, start, low, cut, {});
  CHECK(bounded.converged);
  CHECK(bounded.at[0] == 0.5);
  CHECK(bounded.at[1] == relative(0.25, 1e-3));
  CHECK((maximise(valley, start, low, high, {}).at.array() == free.at.array()).all());
  CHECK_FALSE(maximise(valley, start, low, high, {.most_evaluations = 3}).converged);
}

TEST_CASE("where there is no value the climb turns back, and exceptions pass through") {
  Density const cliff = [](Eigen::VectorXd const& x, Eigen::VectorXd& gradient) {
    gradient[0] = 1 / x[0] - 1;
    return x[0] < 0.5 ? -infinity : std::log(x[0]) - x[0];
  };
  Eigen::VectorXd const one = Eigen::VectorXd::Constant(1, 1.0);
  Climb const climb = maximise(cliff, 9 * one, -20 * one, 20 * one, {.scale = 0.01});  // the first step overshoots
  CHECK(climb.at[0] == doctest::Approx(1).epsilon(1e-2));
  Density const thrower = [](Eigen::VectorXd const&, Eigen::VectorXd&) -> double { throw std::runtime_error("here"); };
  CHECK_THROWS_AS(maximise(thrower, one, -one, 2 * one, {}), std::runtime_error);
  Density const nowhere = [](Eigen::VectorXd const&, Eigen::VectorXd&) { return -infinity; };
  CHECK(maximise(nowhere, one, -one, 2 * one, {}).value == -infinity);
}

TEST_CASE("the optimum of scikit-learn 1.2.1 is found") {
  Observations const o = recorded(200);
  Covariance const covariance = kernel("squared_exponential", {0, 1});
  std::vector<Range> const ranges = {
      {"amplitude", 1e-3, 1e3, 1}, {"length", 1e-4, 1e4, 1}, {"length", 1e-4, 1e4, 1}, {"sd", 1e-5, 1e2, 1}};
  Fit const found = fit(dense(covariance, o), {}, ranges, 200, from_starts(1));
  REQUIRE(found.optima.size() == 1);
  CHECK(found.concerns.empty());
  CHECK(found.optima[0].log_likelihood == doctest::Approx(121.67411935003278).epsilon(1e-9));
  // Its coordinates: logarithms of amplitude^2, lengths, noise variance.
  double const expected[] = {-0.019891783534981278, 0.6777383680639075, 1.208100815735573, -4.846575909179534};
  for (std::size_t j = 0; j < 4; ++j) {
    double const squared = j == 0 || j == 3 ? 2 : 1;
    CHECK(std::fabs(squared * std::log(found.optima[0].parameters[j]) - expected[j]) < 1e-3);
  }
}

TEST_CASE("suggested ranges lead to the same optimum from every start") {
  Observations const o = recorded(200);
  Covariance const covariance = kernel("squared_exponential", {0, 1});
  auto const ranges = suggested_ranges(covariance, o);
  REQUIRE(ranges.has_value());
  CHECK(ranges->at(2).name == "length of input 2");
  Fit const found = fit(dense(covariance, o), {}, *ranges, 200, from_starts(5));
  REQUIRE(found.optima.size() == 5);
  CHECK(found.optima[0].log_likelihood == doctest::Approx(121.674119).epsilon(1e-7));
  CHECK_FALSE(suggested_ranges(kernel("oscillator"), o).has_value());
}

TEST_CASE("a prior moves the optimum to where the sum of slopes is zero") {
  Observations const o = recorded(100);
  Covariance const covariance = kernel("matern52", {0, 1});
  auto ranges = *suggested_ranges(covariance, o);
  LogPrior const prior = [](Eigen::VectorXd const& u, Eigen::VectorXd& gradient) {
    double const z = (u[1] - 0.2) / 0.05;
    gradient[1] -= z / 0.05;
    return -0.5 * z * z - std::log(0.05 * std::sqrt(2 * std::numbers::pi));
  };
  Fit const found = fit(dense(covariance, o), prior, ranges, 100, from_starts(1));
  REQUIRE(found.optima.size() == 1);
  Optimum const& best = found.optima[0];
  Marginal const there = dense_marginal(covariance, o, best.parameters, true);
  Eigen::VectorXd slope = there.gradient, logarithms(4);
  for (int j = 0; j < 4; ++j) logarithms[j] = std::log(best.parameters[static_cast<std::size_t>(j)]);
  double const log_prior = prior(logarithms, slope);
  CHECK(slope.norm() < 0.05);
  CHECK(std::fabs(there.gradient[1]) > 0.5);
  CHECK(best.log_density == doctest::Approx(there.log_likelihood + log_prior).epsilon(1e-10));
}

TEST_CASE("a parameter at its bound is named, one inside is not; known ones stay exactly") {
  Observations const o = recorded(100);
  Covariance const covariance = kernel("squared_exponential", {0, 1});
  std::vector<Range> const ranges = {
      {"amplitude", 1e-3, 1e3, 1}, {"length", 0.3, 0.3, 0.3}, {"span", 1e-2, 0.7, 0.5}, {"sd", 1e-5, 10, 1}};
  Fit const found = fit(dense(covariance, o), {}, ranges, 100, from_starts(2));
  REQUIRE_FALSE(found.optima.empty());
  CHECK(found.optima[0].parameters[1] == 0.3);
  int named = 0;
  for (Concern const& concern : found.concerns)
    if (concern.kind == Concern::Kind::at_bound) {
      ++named;
      CHECK(concern.parameter == 2);
      CHECK(concern.value == 0.7);
      CHECK(concern.clause == "span ended at the upper bound of its range, 0.7");
    }
  CHECK(named == 1);
}

TEST_CASE("two optima are told apart, and starts do not depend on each other") {
  // Maxima near log p = -1 and 1, the right one higher by 0.2.
  Likelihood const two = curve([](double u) { return -10 * (u * u - 1) * (u * u - 1) + 0.1 * u; },
                               [](double u) { return -40 * u * (u * u - 1) + 0.1; });
  std::vector<Range> const range = {{"p", 1e-2, 1e2, std::exp(-0.8)}};
  Fit const many = fit(two, {}, range, 1, from_starts(8)), one = fit(two, {}, range, 1, from_starts(1));
  CHECK(std::log(many.optima.front().parameters[0]) == doctest::Approx(1).epsilon(0.01));
  CHECK(std::log(one.optima.front().parameters[0]) == doctest::Approx(-1).epsilon(0.01));
  CHECK(has(many.concerns, Concern::Kind::restarts_differ));
  CHECK(one.concerns.empty());
  Fit const again = fit(two, {}, range, 1, from_starts(8)), more = fit(two, {}, range, 1, from_starts(9));
  for (std::size_t i = 0; i < 8; ++i) CHECK(again.optima[i].parameters == many.optima[i].parameters);
  int found = 0;
  for (Optimum const& a : many.optima)
    for (Optimum const& b : more.optima)
      if (a.parameters == b.parameters) {
        ++found;
        break;
      }
  CHECK(found == 8);
}

TEST_CASE("without a finite start there is no result but a fatal concern") {
  Fit const found =
      fit(curve([](double) { return -infinity; }, [](double) { return 0.0; }), {}, {{"p", 0.1, 10, 1}}, 1, from_starts(3));
  CHECK(found.optima.empty());
  REQUIRE(found.concerns.size() == 1);
  CHECK(found.concerns[0].kind == Concern::Kind::not_positive_definite);
  CHECK(fatal(found.concerns[0].kind));
}

TEST_CASE("jitter and too few evaluations are told") {
  Observations o;
  o.inputs = made_inputs(30, 1, 1);
  o.values = made_values(o.inputs, 0);
  Covariance const covariance = kernel("squared_exponential");
  std::vector<Range> const exact = {{"amplitude", 1, 1, 1}, {"length", 2, 2, 2}, {"sd", 0, 0, 0}};
  Fit const known = fit(dense(covariance, o), {}, exact, 30, from_starts(3));
  REQUIRE(known.optima.size() == 1);
  CHECK(known.optima[0].parameters[2] == 0);
  CHECK(has(known.concerns, Concern::Kind::jitter));
  Observations const noisy = recorded(60);
  Covariance const both = kernel("squared_exponential", {0, 1});
  FitSettings few = from_starts(1);
  few.most_evaluations = 3;
  CHECK(has(fit(dense(both, noisy), {}, *suggested_ranges(both, noisy), 60, few).concerns, Concern::Kind::no_convergence));
}

TEST_CASE("equal inputs and places outside are found in the columns that are read") {
  Eigen::MatrixXd inputs(5, 2), places(3, 2);
  inputs << 0, 1, 1, 2, 0, 3, 1, 2, 0, 5;
  CHECK(repeated_inputs(inputs, {0}) == 3);
  CHECK(repeated_inputs(inputs, {0, 1}) == 1);
  CHECK(repeated_inputs(inputs, {1}) == 1);
  CHECK(duplicates_without_noise(inputs, {0, 1}).front().value == 1);
  CHECK(duplicates_without_noise(inputs.topRows(2), {0, 1}).empty());
  places << 0.5, 9, 1.05, 4, -0.04, 0.7;
  Concerns const concerns = places_outside(inputs, places, {0, 1});
  REQUIRE(concerns.size() == 1);  // a twentieth of the range outside is near enough
  CHECK(concerns[0].column == 1);
  CHECK(concerns[0].value == doctest::Approx(1));
  CHECK(concerns[0].clause == "1 of 3 places lie outside the observations in input 2, by up to 1 times their range");
  inputs.col(0).setConstant(1);
  Concerns const constant = places_outside(inputs, places, {0});
  REQUIRE(constant.size() == 1);
  CHECK(constant[0].clause == "3 of 3 places lie outside the observations in input 1, which are all the same");
}

TEST_CASE("both routes end at the same optimum") {
  Observations o;
  o.inputs = made_inputs(150, 1, 20);
  o.values = made_values(o.inputs, 0.1);
  Covariance const covariance = kernel("matern32");
  auto const ranges = *suggested_ranges(covariance, o);
  Fit const one = fit(dense(covariance, o), {}, ranges, 150, from_starts(2));
  Fit const other =
      fit([&](Numbers p, bool g) { return state_space_marginal(covariance, o, p, g); }, {}, ranges, 150, from_starts(2));
  REQUIRE_FALSE(one.optima.empty());
  REQUIRE_FALSE(other.optima.empty());
  CHECK(one.optima[0].log_density == doctest::Approx(other.optima[0].log_density).epsilon(1e-9));
}
