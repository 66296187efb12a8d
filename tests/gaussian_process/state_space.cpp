// The filter's route against the dense one: the same likelihood, gradient, predictions and coefficients.
#include "gaussian_process/state_space.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

#include "gaussian_process/dense.hpp"
#include "gaussian_process/made.hpp"

using namespace sysid;
using namespace sysid::gaussian_process;

namespace {

/// Unequal spacing in no order, two equal instants among them.
Observations record(Eigen::Index count, int columns) {
  Observations o;
  o.inputs = made_inputs(count, 1, 20);
  o.inputs(7, 0) = o.inputs(3, 0);
  o.values = made_values(o.inputs, 0.1).array() + 2;
  o.columns.resize(count, columns);
  if (columns > 0) o.columns.col(0).setOnes();
  if (columns > 1) o.columns.col(1) = o.inputs.col(0);
  o.prior_mean = Eigen::VectorXd::Zero(columns);
  o.prior_sd = Eigen::VectorXd::Constant(columns, 1.7);
  if (columns > 0) o.prior_mean[0] = 0.5;
  if (columns > 1) o.prior_sd[1] = std::numeric_limits<double>::infinity();
  return o;
}

std::vector<Covariance> covariances() {
  return {kernel("matern12"),
          kernel("matern32"),
          kernel("matern52"),
          kernel("oscillator"),
          kernel("matern52") + kernel("matern12") + kernel("constant", {}),
          kernel("oscillator") + kernel("matern32") + kernel("matern52") + kernel("matern12")};
}

void check_close(Eigen::VectorXd const& found, Eigen::VectorXd const& expected) {
  CHECK((found - expected).norm() < 1e-8 * (1 + expected.norm()));
}

}  // namespace

TEST_CASE("the state-space route equals the dense one") {
  for (int const columns : {0, 1, 2})
    for (Covariance const& covariance : covariances()) {
      CAPTURE(columns);
      CAPTURE(covariance.terms().front().row->name);
      REQUIRE(has_state_space(covariance));
      Observations const o = record(200, columns);
      std::vector<double> parameters = made_parameters(covariance.parameter_count());
      parameters.push_back(0.12);
      Marginal const dense = dense_marginal(covariance, o, parameters, true);
      Marginal const filtered = state_space_marginal(covariance, o, parameters, true);
      REQUIRE(dense.outcome == Outcome::fine);
      REQUIRE(filtered.outcome == Outcome::fine);
      CHECK(filtered.log_likelihood == doctest::Approx(dense.log_likelihood).epsilon(1e-10));
      check_close(filtered.gradient, dense.gradient);
      check_close(filtered.values_gradient, dense.values_gradient);
      CHECK(state_space_marginal(covariance, o, parameters, false).log_likelihood == filtered.log_likelihood);

      // Places before, between, at and after the observations, in no order.
      Places places;
      places.inputs = made_inputs(60, 1, 30, 5);
      places.inputs(4, 0) = o.inputs(3, 0);
      places.inputs(9, 0) = o.inputs(11, 0);
      places.columns.resize(60, columns);
      if (columns > 0) places.columns.col(0).setOnes();
      if (columns > 1) places.columns.col(1) = places.inputs.col(0);
      DensePosterior const posterior(covariance, o, parameters);
      Prediction const expected = posterior.predict(places);
      StateSpacePosterior const found = state_space_posterior(covariance, o, parameters, places);
      REQUIRE(found.outcome == Outcome::fine);
      check_close(found.prediction.mean, expected.mean);
      check_close(found.prediction.variance, expected.variance);
      if (columns > 0) {
        check_close(found.coefficients.mean, posterior.coefficients().mean);
        check_close(found.coefficients.covariance.reshaped(), posterior.coefficients().covariance.reshaped());
      }
    }
}

TEST_CASE("what has no state-space form is known beforehand") {
  CHECK_FALSE(has_state_space(kernel("squared_exponential")));
  CHECK_FALSE(has_state_space(kernel("matern32") * kernel("matern12")));
  CHECK_FALSE(has_state_space(kernel("matern32", {0, 1})));
  CHECK_FALSE(has_state_space(kernel("matern32", {0}) + kernel("matern32", {1})));
  CHECK_FALSE(has_state_space(kernel("constant", {})));                                        // reads no input
  CHECK_FALSE(has_state_space(kernel("matern52") + kernel("matern52") + kernel("matern52")));  // nine states
  CHECK(has_state_space(kernel("matern52", {2}) + kernel("constant", {})));
}

TEST_CASE("equal instants without noise are refused") {
  Observations const o = record(20, 0);
  std::vector<double> const parameters = {1, 2, 0};
  CHECK(state_space_marginal(kernel("matern12"), o, parameters, true).outcome == Outcome::not_positive_definite);
  CHECK(state_space_posterior(kernel("matern12"), o, parameters, {o.inputs, {}}).outcome == Outcome::not_positive_definite);
}

TEST_CASE("without noise the function passes through the observations") {
  Observations o = record(20, 0);
  o.inputs(7, 0) += 0.37;
  StateSpacePosterior const found = state_space_posterior(kernel("matern32"), o, std::vector<double>{1, 2, 0}, {o.inputs, {}});
  REQUIRE(found.outcome == Outcome::fine);
  CHECK((found.prediction.mean - o.values).norm() < 1e-8);
  CHECK(found.prediction.variance.maxCoeff() < 1e-10);
}

TEST_CASE("a long record's likelihood is the sum over what a short memory cuts apart") {
  // Two stretches so far apart that the process forgets: their likelihoods add.
  Observations first = record(3000, 0), second = record(2000, 0), both;
  second.inputs.array() += 1e4;
  both.inputs.resize(5000, 1);
  both.inputs << first.inputs, second.inputs;
  both.values.resize(5000);
  both.values << first.values, second.values;
  std::vector<double> const parameters = {1.1, 0.8, 0.12};
  Covariance const covariance = kernel("matern52");
  auto const at = [&](Observations const& o) { return state_space_marginal(covariance, o, parameters, true); };
  CHECK(at(both).log_likelihood == doctest::Approx(at(first).log_likelihood + at(second).log_likelihood).epsilon(1e-12));
  check_close(at(both).gradient, at(first).gradient + at(second).gradient);
}
