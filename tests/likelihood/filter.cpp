// The likelihood of models with disturbances against the joint normal density of all samples at once.
#include <doctest/doctest.h>

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "likelihood/linear_system.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

TEST_CASE("the likelihood of a linear model with a disturbance is the joint normal density of its samples") {
  std::vector<double> const values = {1.3, 4, 130, 0.02, 0.004};
  LinearSystem const system = oscillator_system(1.3, 4, 130, 0.02, 0.004);
  Model const model = with_disturbance(filtered_file(filtered_text).models.front(), "w", "q");
  SUBCASE("exact steps") {
    FilterRecord const of = record(60, 2, true);
    ModelTarget const target(compile(model, false, "exponential"), of.experiment, filter_options("exponential", 1));
    CHECK(value_at(target, values) == doctest::Approx(joint_density(system, of.experiment.time, of.u, of.y)).epsilon(1e-11));
  }
  SUBCASE("exact steps, all of another length") {
    FilterRecord const of = record(60, 2, false);
    ModelTarget const target(compile(model, false, "exponential"), of.experiment, filter_options("exponential", 1));
    CHECK(value_at(target, values) == doctest::Approx(joint_density(system, of.experiment.time, of.u, of.y)).epsilon(1e-11));
  }
  SUBCASE("rk4, unequal steps") {
    FilterRecord const of = record(60, 2, false);
    ModelTarget const target(compile(model, false, "rk4"), of.experiment, filter_options("rk4", 40));
    CHECK(value_at(target, values) == doctest::Approx(joint_density(system, of.experiment.time, of.u, of.y)).epsilon(1e-10));
  }
  SUBCASE("adaptive steps") {
    FilterRecord const of = record(60, 2, false);
    TargetOptions options = filter_options("dopri5", 1);
    options.solver.relative = 1e-11;
    ModelTarget const target(compile(model, false, "dopri5"), of.experiment, options);
    CHECK(value_at(target, values) == doctest::Approx(joint_density(system, of.experiment.time, of.u, of.y)).epsilon(1e-9));
  }
  SUBCASE("a stiff solver") {
    FilterRecord const of = record(60, 2, false);
    TargetOptions options = filter_options("cvode", 1);
    options.solver.relative = 1e-9;
    ModelTarget const target(compile(model, false, "cvode"), of.experiment, options);
    CHECK(value_at(target, values) == doctest::Approx(joint_density(system, of.experiment.time, of.u, of.y)).epsilon(1e-6));
  }
  SUBCASE("sigma points") {
    FilterRecord const of = record(60, 2, false);
    ModelTarget const target(compile(model, false, "rk4", FilterRule::unscented), of.experiment, filter_options("rk4", 40));
    CHECK(value_at(target, values) == doctest::Approx(joint_density(system, of.experiment.time, of.u, of.y)).epsilon(1e-10));
  }
}

// Near a known start the covariances at the stages of a Runge-Kutta step have no Cholesky factor.
TEST_CASE("sigma points of a nearly linear model under a force with memory are the extended filter, from a known start on") {
  std::string const text = R"(
model gusts {
  input x [N], z [N]
  state y [m]
  initial y = 0, y' = 0
  parameter m [kg] ~ log_uniform(0.1, 10)
  parameter c [N s/m] ~ log_uniform(0.1, 100)
  parameter k [N/m] ~ log_uniform(10, 1000)
  parameter s [N] ~ log_uniform(1e-3, 10)
  parameter sigma [m] ~ log_uniform(1e-5, 1)
  disturbance w [N] ~ ornstein_uhlenbeck(sd = s, time = 0.1 [s])
  m*y'' + c*y' + k*y + 1000 [N/m^3]*y^3 = x + z + w
  observe displacement ~ normal(y, sd = sigma)
  observe speed [m/s] ~ normal(y', sd = 0.03)
}
)";
  Model const model = filtered_file(text).models.front();
  FilterRecord const of = record(60, 2, false);
  std::vector<double> const values = {1.3, 4, 130, 0.2, 0.004};
  ModelTarget const extended(compile(model, false, "rk4"), of.experiment, filter_options("rk4", 1));
  ModelTarget const unscented(compile(model, false, "rk4", FilterRule::unscented), of.experiment, filter_options("rk4", 1));
  double const expected = value_at(extended, values);
  REQUIRE(std::isfinite(expected));
  CHECK(value_at(unscented, values) == doctest::Approx(expected).epsilon(1e-3));
}

TEST_CASE("sigma points lie on both sides of a jump of the equations and of a channel") {
  std::string const text = R"(
model stuck {
  state x [m], z [m]
  initial x ~ normal(0, sd = 0.3), z ~ normal(0.1, sd = 0.2)
  parameter f [m/s] ~ log_uniform(0.1, 10)
  x' = -f*sign(z)
  z' = -0.5 [1/s]*z
  observe first [m] ~ normal(z, sd = 0.05)
  observe second [m] ~ normal(x, sd = 0.04)
  observe side ~ normal(if z > 0 [m] then 1 else 0, sd = 0.5)
}
)";
  Model const model = filtered_file(text).models.front();
  double const h = 0.1, f = 1.7, measured[] = {0.03, -0.2, 0.8};
  Experiment experiment;
  experiment.time = {0, h};
  experiment.scored = {0, 1};
  for (double const y : measured) experiment.measured.push_back({0, y});
  auto const of = [&](FilterRule rule) {
    return value_at(ModelTarget(compile(model, false, "euler", rule), experiment, filter_options("euler", 1)), {f});
  };
  auto const density = [](double y, double mean, double variance) {
    return -0.5 * ((y - mean) * (y - mean) / variance + std::log(2 * std::numbers::pi * variance));
  };
  // One step from two independent states: sign(z) is 1 at the mean and one point, -1 at the other, and points along x see none of
  // it. What is linear passes by slopes.
  auto const expected = [&](bool points) {
    double const root = std::sqrt(3.0) * 0.2, mean_sign = points ? 2.0 / 3 : 1, with_sign = points ? root / 3 : 0;
    double mean_x = -h * f * mean_sign, mean_z = 0.1 * (1 - 0.5 * h);
    double var_x = 0.09, cov = -h * f * with_sign;
    // Between samples the unscented filter takes Euler's step of P itself, the extended one the map that its step is.
    double var_z = 0.04 * (points ? 1 - h : (1 - 0.5 * h) * (1 - 0.5 * h));
    double total = 0;
    double s = var_z + 0.0025;
    total += density(measured[0], mean_z, s);
    mean_x += cov / s * (measured[0] - mean_z);
    mean_z += var_z / s * (measured[0] - mean_z);
    var_x -= cov * cov / s;
    cov -= cov * var_z / s;
    var_z -= var_z * var_z / s;
    s = var_x + 0.0016;
    total += density(measured[1], mean_x, s);
    mean_z += cov / s * (measured[1] - mean_x);
    var_z -= cov * cov / s;
    cov -= cov * var_x / s;
    var_x -= var_x * var_x / s;
    // The share of the points that lie behind the jump.
    double const along_x = std::sqrt(3 / var_x) * cov, along_z = std::sqrt(3 * (var_z - cov * cov / var_x));
    double behind = 0;
    for (double const offset : {along_x, -along_x, along_z, -along_z})
      if (points && mean_z + offset < 0) behind += 1.0 / 6;
    return total + density(measured[2], 1 - behind, behind * (1 - behind) + 0.25);
  };
  CHECK(of(FilterRule::extended) == doctest::Approx(expected(false)).epsilon(1e-12));
  CHECK(of(FilterRule::unscented) == doctest::Approx(expected(true)).epsilon(1e-12));
  CHECK(std::abs(expected(true) - expected(false)) > 1e-3);
}

// z and u vary together with x, but not with one another; the Cholesky factor has an entry for them.
TEST_CASE("sigma points pass through a channel of one of two independent forces") {
  auto const value = [](std::string const& channel, FilterRule rule) {
    Model const model = filtered_file(fmt::format(R"(
model two_forces {{
  state x, z, u
  initial x ~ normal(0, sd = 1), z ~ normal(0, sd = 1), u ~ normal(0, sd = 1)
  parameter k [1/s] ~ log_uniform(0.1, 10)
  x' = -k*x + 1 [1/s]*(z + u)
  z' = -0.5 [1/s]*z
  u' = -0.7 [1/s]*u
  observe seen ~ normal({}, sd = 0.3)
}}
)",
                                                  channel))
                            .models.front();
    Experiment experiment;
    experiment.time = {0, 0.1, 0.2, 0.3};
    experiment.scored.assign(4, 1);
    experiment.measured = {{0.3, 0.1, -0.5, 0.2}};
    return value_at(ModelTarget(compile(model, false, "rk4", rule), experiment, filter_options("rk4", 4)), {1.5});
  };
  double const expected = value("u", FilterRule::extended);
  REQUIRE(std::isfinite(expected));
  CHECK(value("u + 1e-9*u^3", FilterRule::unscented) == doctest::Approx(expected).epsilon(1e-5));
}

TEST_CASE("a disturbance that is held from sample to sample knows their interval, whatever the solver") {
  Model model = with_disturbance(filtered_file(filtered_text).models.front(), "w", "q");
  model.disturbances.front().held = true;
  std::vector<double> const values = {1.3, 4, 130, 0.02, 0.004};
  FilterRecord const of = record(60, 2, false);
  ModelTarget const fixed(compile(model, false, "rk4"), of.experiment, filter_options("rk4", 40));
  double const expected = value_at(fixed, values);
  for (std::string const method : {"dopri5", "cvode"}) {
    TargetOptions options = filter_options(method, 1);
    options.solver.relative = 1e-9;
    ModelTarget const target(compile(model, false, method), of.experiment, options);
    CHECK(value_at(target, values) == doctest::Approx(expected).epsilon(1e-6));
  }
}

TEST_CASE("exact steps keep a held disturbance as it is, alone and beside a white one") {
  Model model = with_disturbance(filtered_file(filtered_text).models.front(), "w", "q");
  LinearSystem system = oscillator_system(1.3, 4, 130, 0.02, 0.004);
  model.disturbances.front().held = system.held = true;
  std::vector<double> const values = {1.3, 4, 130, 0.02, 0.004};
  for (bool const equal : {true, false}) {
    CAPTURE(equal);
    FilterRecord const of = record(60, 2, equal);
    ModelTarget const target(compile(model, false, "exponential"), of.experiment, filter_options("exponential", 1));
    CHECK(value_at(target, values) == doctest::Approx(joint_density(system, of.experiment.time, of.u, of.y)).epsilon(1e-11));
  }
  // Both at once: the sum of what each adds is that of one of them with a share, as both enter the same way and steps are short.
  std::vector<double> sums;
  for (double const share : {0.0, 0.5, 1.0}) {
    Model both = model;
    Graph& graph = both.graph;
    NodeId const q = both.disturbances.front().intensity;
    Disturbance white = both.disturbances.front();
    white.held = false;
    double const step = 0.02;
    white.intensity = graph.multiply(graph.constant(share * step), q);
    both.disturbances.front().intensity = graph.multiply(graph.constant(1 - share), q);
    both.disturbances.push_back(white);
    for (State& state : both.states)
      state.derivative = graph.substitute(state.derivative, [&](NodeId leaf) -> std::optional<NodeId> {
        if (graph[leaf].operation != Operation::leaf || graph[leaf].leaf_kind != LeafKind::disturbance) return std::nullopt;
        return graph.add(leaf, graph.leaf(LeafKind::disturbance, 1));
      });
    FilterRecord const of = record(60, 2, true);
    ModelTarget const target(compile(both, false, "exponential"), of.experiment, filter_options("exponential", 1));
    sums.push_back(value_at(target, values));
  }
  CHECK(sums[1] == doctest::Approx(0.5 * (sums[0] + sums[2])).epsilon(1e-3));
  CHECK(sums[0] != sums[2]);
}

TEST_CASE("residuals and densities of samples are those of the filter") {
  std::vector<double> const values = {1.3, 4, 130, 0.02, 0.004};
  Model const model = with_disturbance(filtered_file(filtered_text).models.front(), "w", "q");
  FilterRecord const of = record(60, 2, false);
  ModelTarget const target(compile(model, false, "rk4"), of.experiment, filter_options("rk4", 4));
  int const dimension = target.dimension();
  LaneArray theta(dimension, 3), declared(dimension, 3);
  for (int w = 0; w < 3; ++w)
    for (int p = 0; p < dimension; ++p) declared(p, w) = values[static_cast<std::size_t>(p)] * (1 + 0.1 * w * (p + 1));
  target.unconstrain(declared, theta);
  std::vector<double> value(3);
  Ledger ledger;
  target.log_likelihood(theta, value, ledger);
  LaneArray residuals(target.residual_count(), 3);
  target.residuals(theta, residuals, ledger);
  std::vector<double> sums(3);
  for (int r = 0; r < residuals.rows(); ++r)
    for (int w = 0; w < 3; ++w) sums[static_cast<std::size_t>(w)] += 0.5 * residuals(r, w) * residuals(r, w);
  CHECK(value[0] + sums[0] == doctest::Approx(value[1] + sums[1]).epsilon(1e-10));
  CHECK(value[0] + sums[0] == doctest::Approx(value[2] + sums[2]).epsilon(1e-10));
  CHECK(value[0] != doctest::Approx(value[1]).epsilon(1e-3));
}

TEST_CASE("derivatives of the likelihood of a filter are exact") {
  std::vector<double> const values = {1.3, 4, 130, 0.02, 0.004};
  Model model = with_disturbance(filtered_file(filtered_text).models.front(), "w", "q");
  FilterRule rule = FilterRule::extended;
  SUBCASE("linear") {}
  SUBCASE("a hardening spring, extended") {
    std::string text = filtered_text;
    text.replace(text.find("k*y = x"), 7, "k*y + 4e5 [N/m^3]*y^3 = x");
    model = with_disturbance(filtered_file(text).models.front(), "w", "q");
  }
  SUBCASE("a hardening spring, unscented") {
    std::string text = filtered_text;
    text.replace(text.find("k*y = x"), 7, "k*y + 4e5 [N/m^3]*y^3 = x");
    model = with_disturbance(filtered_file(text).models.front(), "w", "q");
    rule = FilterRule::unscented;
  }
  FilterRecord const of = record(60, 2, false);
  ModelTarget const target(compile(model, false, "rk4", rule), of.experiment, filter_options("rk4", 4));
  CHECK(target.derivatives() == DerivativeSource::exact);
  int const dimension = target.dimension();
  LaneArray theta(dimension, 1), declared(dimension, 1);
  for (int p = 0; p < dimension; ++p) declared(p, 0) = values[static_cast<std::size_t>(p)];
  target.unconstrain(declared, theta);
  double value = 0;
  LaneArray gradient(dimension, 1);
  Ledger ledger;
  target.log_likelihood_gradient(theta, {&value, 1}, gradient, ledger);
  for (int p = 0; p < dimension; ++p) {
    // Richardson: the error of the fourth order is 1e-9 of the slope here.
    double const step = 2e-4;
    LaneArray moved(dimension, 4);
    double const by[] = {step, -step, 2 * step, -2 * step};
    for (int w = 0; w < 4; ++w)
      for (int i = 0; i < dimension; ++i) moved(i, w) = theta(i, 0) + (i == p ? by[w] : 0);
    std::vector<double> out(4);
    target.log_likelihood(moved, out, ledger);
    double const slope = (8 * (out[0] - out[1]) - (out[2] - out[3])) / (12 * step);
    CHECK(gradient(p, 0) == doctest::Approx(slope).epsilon(1e-7));
  }
}

TEST_CASE("widths of lanes, threads and machine code do not change a filter") {
  Model const model = with_disturbance(filtered_file(filtered_text).models.front(), "w", "q");
  FilterRecord const of = record(60, 2, false);
  std::vector<std::vector<double>> results;
  for (ExecutionOptions const& execution : {ExecutionOptions{.lanes = 1}, ExecutionOptions{.lanes = 16, .threads = 2},
                                            ExecutionOptions{.lanes = 8, .executor = ExecutorKind::native}}) {
    TargetOptions options = filter_options("rk4", 2);
    options.execution = execution;
    ModelTarget const target(compile(model, false, "rk4"), of.experiment, options);
    LaneArray theta(target.dimension(), 20);
    target.sample_prior({7}, theta);
    std::vector<double> out(20);
    Ledger ledger;
    target.log_likelihood(theta, out, ledger);
    results.push_back(out);
  }
  CHECK(results[0] == results[1]);
  CHECK(results[0] == results[2]);
}

}  // namespace
