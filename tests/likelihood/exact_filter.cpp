// Filters of linear models by exact steps: against the joint normal density in a hundred digits, from starts that are hardly known,
// along records on which the covariance settles.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "likelihood/precise_density.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

Model oscillator_from(double start_variance) {
  Model model = with_disturbance(filtered_file(filtered_text).models.front(), "w", "q");
  if (start_variance > 0)
    for (State& state : model.states) state.initial_variance = model.graph.constant(start_variance);
  return model;
}

TEST_CASE("the likelihood of an exact filter is the joint normal density, however little is known of the start") {
  std::vector<double> const values = {1.3, 4, 130, 0.02, 0.004};
  std::vector<Precise> const precise(values.begin(), values.end());
  FilterRecord const of = record(60, 2, true);
  for (double const ratio : {0.0, 1.0, 1e4, 1e6, 1e8, 1e10}) {
    double const variance = ratio * ratio * 0.004 * 0.004;
    ModelTarget const target(compile(oscillator_from(variance), false, "exponential"), of.experiment,
                             filter_options("exponential", 1));
    double const expected =
        precise_density(precise_oscillator(precise, Precise(variance)), of.experiment.time, of.u, of.y).convert_to<double>();
    INFO(ratio);
    CHECK(value_at(target, values) == doctest::Approx(expected).epsilon(1e-10));
  }
}

TEST_CASE("the gradient of an exact filter is that of the joint normal density") {
  std::vector<double> const values = {1.3, 4, 130, 0.02, 0.004};
  FilterRecord const of = record(40, 2, true);
  for (double const ratio : {0.0, 1e4, 1e8}) {
    double const variance = ratio * ratio * 0.004 * 0.004;
    ModelTarget const target(compile(oscillator_from(variance), false, "exponential"), of.experiment,
                             filter_options("exponential", 1));
    CHECK(target.derivatives() == DerivativeSource::exact);
    int const dimension = target.dimension();
    LaneArray theta(dimension, 1), declared(dimension, 1), gradient(dimension, 1);
    for (int p = 0; p < dimension; ++p) declared(p, 0) = values[static_cast<std::size_t>(p)];
    target.unconstrain(declared, theta);
    double value = 0;
    Ledger ledger;
    target.log_likelihood_gradient(theta, {&value, 1}, gradient, ledger);
    for (int p = 0; p < dimension; ++p) {
      // d value/d coordinate by a difference of doubles of one chain rule: coordinates are smooth functions of one parameter.
      double const h = 1e-4;
      LaneArray around(dimension, 4), at(dimension, 4);
      double const by[] = {h, -h, 2 * h, -2 * h};
      for (int w = 0; w < 4; ++w)
        for (int i = 0; i < dimension; ++i) around(i, w) = theta(i, 0) + (i == p ? by[w] : 0);
      target.constrain(around, at);
      double const slope = (8 * (at(p, 0) - at(p, 1)) - (at(p, 2) - at(p, 3))) / (12 * h);
      Precise const step = pow(Precise(10), -30);
      auto const density = [&](Precise const& change) {
        std::vector<Precise> moved(values.begin(), values.end());
        moved[static_cast<std::size_t>(p)] += change;
        return precise_density(precise_oscillator(moved, Precise(variance)), of.experiment.time, of.u, of.y);
      };
      Precise const by_value = (density(step) - density(-step)) / (2 * step);
      INFO(ratio, " parameter ", p);
      CHECK(gradient(p, 0) == doctest::Approx(by_value.convert_to<double>() * slope).epsilon(1e-8));
    }
  }
}

// All steps of another length.
TEST_CASE("the gradient of an exact filter along unequal steps is that of the joint normal density") {
  std::vector<double> const values = {1.3, 4, 130, 0.02, 0.004};
  FilterRecord const of = record(60, 2, false);
  ModelTarget const target(compile(oscillator_from(0), false, "exponential"), of.experiment, filter_options("exponential", 1));
  LaneArray const theta = coordinates_of(target, values);
  int const dimension = target.dimension();
  LaneArray gradient(dimension, 1);
  double value = 0;
  Ledger ledger;
  target.log_likelihood_gradient(theta, {&value, 1}, gradient, ledger);
  for (int p = 0; p < dimension; ++p) {
    double const h = 1e-3, by[] = {h, -h, 2 * h, -2 * h};
    LaneArray around(dimension, 4), at(dimension, 4);
    for (int w = 0; w < 4; ++w)
      for (int i = 0; i < dimension; ++i) around(i, w) = theta(i, 0) + (i == p ? by[w] : 0);
    target.constrain(around, at);
    auto const density = [&](int w) {
      return joint_density(oscillator_system(at(0, w), at(1, w), at(2, w), at(3, w), at(4, w)), of.experiment.time, of.u, of.y);
    };
    CHECK(gradient(p, 0) == doctest::Approx((8 * (density(0) - density(1)) - (density(2) - density(3))) / (12 * h)).epsilon(1e-7));
  }
}

std::string const chain_text = R"(
model chain {
  input x [N], w [N]
  state y(5) [m]
  initial y = 0, y' = 0
  parameter k [N/m] ~ log_uniform(10, 1e4)
  parameter c [N s/m] ~ log_uniform(0.01, 100)
  parameter q [N^2 s] ~ log_uniform(1e-6, 1)
  parameter sigma [m] ~ log_uniform(1e-6, 1)
  y[1]'' = (k*(y[2] - 2*y[1]) + c*(y[2]' - 2*y[1]'))/1 [kg]
  y[2]'' = (k*(y[1] - 2*y[2] + y[3]) + c*(y[1]' - 2*y[2]' + y[3]'))/1 [kg]
  y[3]'' = (k*(y[2] - 2*y[3] + y[4]) + c*(y[2]' - 2*y[3]' + y[4]'))/1 [kg]
  y[4]'' = (k*(y[3] - 2*y[4] + y[5]) + c*(y[3]' - 2*y[4]' + y[5]'))/1 [kg]
  y[5]'' = (k*(y[4] - y[5]) + c*(y[4]' - y[5]') + x + w)/1 [kg]
  observe first ~ normal(y[1], sd = sigma)
  observe speed [m/s] ~ normal(y[5]', sd = 0.03)
}
)";

LinearSystem chain_system(Model const& model, double k, double c, double q, double sigma) {
  LinearSystem system;
  auto const place = [&](std::string const& name) {
    for (std::size_t s = 0; s < model.states.size(); ++s)
      if (model.states[s].name == name) return static_cast<Eigen::Index>(s);
    FAIL("no state ", name);
    return Eigen::Index{0};
  };
  system.a = Eigen::MatrixXd::Zero(10, 10);
  for (int i = 1; i <= 5; ++i) {
    auto const at = [&](int j) { return place("y[" + std::to_string(j) + "]"); };
    auto const speed = [&](int j) { return place("y[" + std::to_string(j) + "]'"); };
    system.a(at(i), speed(i)) = 1;
    for (int const j : {i - 1, i + 1}) {
      if (j > 5) continue;
      system.a(speed(i), at(i)) -= k;
      system.a(speed(i), speed(i)) -= c;
      if (j < 1) continue;
      system.a(speed(i), at(j)) += k;
      system.a(speed(i), speed(j)) += c;
    }
  }
  system.b = Eigen::MatrixXd::Zero(10, 1);
  system.b(place("y[5]'"), 0) = 1;
  system.g = system.b;
  system.h = Eigen::MatrixXd::Zero(2, 10);
  system.h(0, place("y[1]")) = 1;
  system.h(1, place("y[5]'")) = 1;
  system.start = Eigen::VectorXd::Zero(10);
  system.start_covariance = Eigen::MatrixXd::Zero(10, 10);
  system.q = Eigen::MatrixXd::Constant(1, 1, q);
  system.r = Eigen::Matrix2d{{sigma * sigma, 0}, {0, 9e-4}};
  return system;
}

TEST_CASE("an exact filter of ten states is the joint normal density") {
  Model const model = with_disturbance(filtered_file(chain_text).models.front(), "w", "q");
  FilterRecord const of = record(100, 2, true);
  ModelTarget const target(compile(model, false, "exponential"), of.experiment, filter_options("exponential", 1));
  LinearSystem const system = chain_system(model, 300, 0.8, 0.02, 0.001);
  double const expected = joint_density(system, of.experiment.time, of.u, of.y);
  CHECK(value_at(target, {300, 0.8, 0.02, 0.001}) == doctest::Approx(expected).epsilon(1e-10));
}

void check_settled(std::string const& method) {
  Model const model = oscillator_from(0.01);
  FilterRecord const of = record(500, 2, true);
  auto const target_with = [&](ExecutionOptions const& execution) {
    TargetOptions options = filter_options(method, 1);
    options.execution = execution;
    return std::make_unique<ModelTarget>(compile(model, false, method), of.experiment, options);
  };
  auto const wide = target_with({.lanes = 16});
  int const dimension = wide->dimension();
  constexpr int width = 20;
  LaneArray theta(dimension, width);
  wide->sample_prior({7}, theta);
  Ledger ledger;
  std::vector<double> values(width);
  LaneArray gradient(dimension, width);
  wide->log_likelihood_gradient(theta, values, gradient, ledger);
  SUBCASE("lanes and machine code") {
    for (ExecutionOptions const& execution :
         {ExecutionOptions{.lanes = 1, .executor = ExecutorKind::scalar}, ExecutionOptions{.lanes = 16, .threads = 2},
          ExecutionOptions{.lanes = 8, .executor = ExecutorKind::native}}) {
      auto const other = target_with(execution);
      std::vector<double> again(width);
      LaneArray of_again(dimension, width);
      other->log_likelihood_gradient(theta, again, of_again, ledger);
      CHECK(again == values);
      for (int p = 0; p < dimension; ++p) CHECK(std::ranges::equal(of_again.row(p), gradient.row(p)));
    }
  }
  SUBCASE("the whole program, which residuals are recorded by") {
    LaneArray residuals(wide->residual_count(), width);
    wide->residuals(theta, residuals, ledger);
    std::vector<double> plain(width), whole(width);
    wide->log_likelihood(theta, plain, ledger);
    for (int w = 0; w < width; ++w) {
      for (int r = 0; r < residuals.rows(); ++r) whole[static_cast<std::size_t>(w)] += 0.5 * residuals(r, w) * residuals(r, w);
      CHECK(plain[static_cast<std::size_t>(w)] == doctest::Approx(values[static_cast<std::size_t>(w)]).epsilon(1e-11));
      CHECK(whole[static_cast<std::size_t>(w)] + plain[static_cast<std::size_t>(w)] ==
            doctest::Approx(whole[0] + plain[0]).epsilon(1e-11));
    }
  }
  SUBCASE("differences") {
    for (int p = 0; p < dimension; ++p) {
      double const step = 2e-4, by[] = {step, -step, 2 * step, -2 * step};
      LaneArray moved(dimension, 4);
      for (int w = 0; w < 4; ++w)
        for (int i = 0; i < dimension; ++i) moved(i, w) = theta(i, 3) + (i == p ? by[w] : 0);
      std::vector<double> out(4);
      wide->log_likelihood(moved, out, ledger);
      double const slope = (8 * (out[0] - out[1]) - (out[2] - out[3])) / (12 * step);
      CHECK(gradient(p, 3) == doctest::Approx(slope).epsilon(1e-6));
    }
  }
}

TEST_CASE("where the covariance of an exact filter settles, likelihood and gradient stay what they are, lane by lane") {
  check_settled("exponential");
}

TEST_CASE("where the covariance of a filter by rk4 settles, likelihood and gradient stay what they are, lane by lane") {
  check_settled("rk4");
}

TEST_CASE("a filter whose covariance settles is the joint normal density") {
  std::vector<double> const values = {1.3, 4, 130, 0.02, 0.004};
  FilterRecord of = record(500, 2, true);
  LinearSystem system = oscillator_system(1.3, 4, 130, 0.02, 0.004);
  system.start_covariance = 0.01 * Eigen::Matrix2d::Identity();
  Model const model = oscillator_from(0.01);
  SUBCASE("no gap") {}
  SUBCASE("a gap, and rows that are not scored") {
    of.y(1, 120) = of.experiment.measured[1][120] = std::nan("");
    for (int const i : {490, 499}) {
      of.experiment.scored[static_cast<std::size_t>(i)] = 0;
      of.y(0, i) = of.y(1, i) = std::nan("");
    }
  }
  ModelTarget const target(compile(model, false, "exponential"), of.experiment, filter_options("exponential", 1));
  CHECK(value_at(target, values) == doctest::Approx(joint_density(system, of.experiment.time, of.u, of.y)).epsilon(1e-11));
}

}  // namespace
