// Estimated starts: whatever the unit of a state, from any initial value, and never a start that was not found.
#include "likelihood/start_state.hpp"

#include <doctest/doctest.h>

#include <fmt/format.h>

#include <cmath>

#include "check/checking.hpp"
#include "likelihood/model_target.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

/// y' = -r y^3/size^2 in units of `size`, from 1 with r = 1 and a little noise: y = 1/sqrt(1 + 2 t).
Experiment record(double size) {
  Experiment experiment;
  std::vector<double> values;
  for (int i = 0; i < 30; ++i) {
    experiment.time.push_back(0.05 * i);
    values.push_back(size * (1 / std::sqrt(1 + 0.1 * i) + 0.005 * std::sin(37.0 * i * i)));
  }
  experiment.scored.assign(experiment.time.size(), 1);
  experiment.measured = {values};
  return experiment;
}

std::string model(double size, double initial) {
  return fmt::format(
      "state y\ninitial y = {:.17g}\nparameter r ~ log_uniform(0.01, 1000)\ny' = -r*y^3*{:.17g}\n"
      "observe o ~ normal(y, sd = {:.17g})\n",
      initial * size, 1 / (size * size), 0.005 * size);
}

/// The start at each rate, the model in units of `size` from `initial`.
std::vector<double> starts(double size, double initial, std::vector<double> const& rates) {
  auto const compiled = compile(model_of(model(size, initial)), true, "rk4");
  StartState const start(compiled, record(size), 20, {.substeps = 40}, {});
  LaneArray parameters(compiled->parameter_rows(), static_cast<int>(rates.size()));
  for (std::size_t w = 0; w < rates.size(); ++w) parameters(0, static_cast<int>(w)) = rates[w];
  start.estimate(parameters);
  std::vector<double> found;
  for (int w = 0; w < parameters.width(); ++w) found.push_back(parameters(1, w) / size);
  return found;
}

}  // namespace

TEST_CASE("an estimated start does not depend on the unit of the state") {
  std::vector<double> const rates = {0.1, 0.5, 1, 3, 10};
  std::vector<double> const expected = starts(1, 3, rates);
  CHECK(expected[2] == doctest::Approx(1).epsilon(0.01));  // twenty samples with noise of half a percent
  for (double const size : {1e-21, 1e-9, 1e-3, 1e6, 1e15}) {
    CAPTURE(size);
    std::vector<double> const found = starts(size, 3, rates);
    for (std::size_t w = 0; w < rates.size(); ++w) CHECK(found[w] == doctest::Approx(expected[w]).epsilon(1e-8));
  }
}

TEST_CASE("the same numbers in another unit have the same likelihood, for every solver and start") {
  auto const log_likelihoods = [](std::string const& unit, double scale, char const* method, int rows) {
    std::string const text = fmt::format(
        "state n [{0}]\ninitial n = 2\nparameter r [1/s] ~ log_uniform(0.1, 50)\nn' = -r*n^3/1 [{0}^2]\n"
        "observe a ~ normal(n, sd = 0.01)\n",
        unit);
    Experiment const experiment = record(scale);
    TargetOptions options;
    options.start_rows = rows;
    options.solver = {.method = method};
    options.solver.relative = 1e-11;  // slopes of the start are differences of 1e-4
    options.solver.substeps = 4;
    ModelTarget const target(compile(model_of(text), rows > 0, method), experiment, options);
    LaneArray declared(1, 3), theta(1, 3);
    for (int w = 0; w < 3; ++w) declared(0, w) = 0.5 * std::pow(2, w);
    target.unconstrain(declared, theta);
    Ledger ledger;
    std::vector<double> out(3);
    target.log_likelihood(theta, out, ledger);
    CHECK(ledger.failed() == 0);
    return out;
  };
  for (char const* method : {"rk4", "dopri5", "cvode", "ida"})
    for (int const rows : {0, 10}) {
      CAPTURE(method);
      CAPTURE(rows);
      std::vector<double> const mol = log_likelihoods("mol", 1, method, rows), zmol = log_likelihoods("zmol", 1e-21, method, rows);
      for (std::size_t w = 0; w < 3; ++w) CHECK(zmol[w] == doctest::Approx(mol[w]).epsilon(1e-6));
    }
}

TEST_CASE("a channel that is at rest in the window is weighed by how it moves later") {
  for (double const size : {1.0, 1e-9}) {
    Experiment experiment;
    experiment.measured.resize(2);
    double sum = 0, square = 0;
    for (int i = 0; i < 40; ++i) {
      experiment.time.push_back(0.05 * i);
      double const position = i < 10 ? 0.1 : 0.1 * i;
      experiment.measured[0].push_back(position * size);
      experiment.measured[1].push_back((2 + (i % 2 == 0 ? 0.2 : -0.2)) * size);
      sum += position / 40;
      square += position * position / 40;
    }
    experiment.scored.assign(40, 1);
    auto const compiled = compile(model_of(fmt::format("state y\ninitial y = {0:.17g}\nparameter r ~ log_uniform(0.01, 1000)\n"
                                                       "y' = -r*y\nobserve resting ~ normal(y, sd = {0:.17g})\n"
                                                       "observe other ~ normal(2*y, sd = {0:.17g})\n",
                                                       size)),
                                  true, "rk4");
    StartState const start(compiled, experiment, 10, {.substeps = 1}, {});
    LaneArray parameters(compiled->parameter_rows(), 1);
    parameters(0, 0) = 0;  // y stays where it is
    start.estimate(parameters);
    // 0.1 by the first channel and 1 by the second, whose slope is 2 and whose sd in the window is 0.2.
    double const first = 1 / (square - sum * sum), second = 4 / 0.04;
    CHECK(parameters(1, 0) / size == doctest::Approx((0.1 * first + second) / (first + second)).epsilon(1e-7));
  }
}

TEST_CASE("an estimated start does not depend on the initial value it begins at") {
  std::vector<double> const rates = {0.1, 0.5, 1, 3};
  std::vector<double> const expected = starts(1, 1, rates);
  for (double const initial : {0.3, 3.0, 10.0}) {
    CAPTURE(initial);
    std::vector<double> const found = starts(1, initial, rates);
    for (std::size_t w = 0; w < rates.size(); ++w) CHECK(found[w] == doctest::Approx(expected[w]).epsilon(1e-6));
  }
}

TEST_CASE("a start that is not found is counted as such, and never used") {
  // Newton's method on the cube root doubles its distance with every step: half of each is taken, and one is as doubtful as the
  // one before.
  auto const compiled = compile(model_of("state y\ninitial y = 1\nparameter r ~ uniform(0, 1)\ny' = 0\n"
                                         "observe o ~ normal(r + sign(y)*abs(y)^(1/3), sd = 0.1)\n"),
                                true, "rk4");
  Experiment experiment = record(1);
  experiment.measured[0].assign(experiment.time.size(), 0.5);
  TargetOptions options;
  options.start_rows = 20;
  ModelTarget const target(compiled, experiment, options);
  LaneArray declared(1, 1), theta(1, 1);
  declared(0, 0) = 0.5;
  target.unconstrain(declared, theta);
  Ledger ledger;
  std::vector<double> out(1);
  target.log_likelihood(theta, out, ledger);
  CHECK(out[0] == -HUGE_VAL);
  REQUIRE(ledger.failures().size() == 1);
  CHECK(ledger.failures()[0].kind == FailureClass::convergence);
  CHECK(ledger.failures()[0].where == "the estimated start");
}
