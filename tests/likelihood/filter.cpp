// The likelihood of models with disturbances against the joint normal density of all samples at once, which shares no code: matrix
// exponentials by Eigen, one covariance matrix, one Cholesky factor.
#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>

#include "likelihood/model_target.hpp"
#include "load/load.hpp"

using namespace sysid;

namespace {

CheckedFile filtered_file(std::string const& text) {
  Source source("case.sysid", text);
  Diagnostics diagnostics;
  auto file = load(source, diagnostics);
  REQUIRE_MESSAGE(file, render(diagnostics, source));
  return *file;
}

/// x' = A x + B u + G w, y = H x + v; u held from sample to sample.
struct LinearSystem {
  Eigen::MatrixXd a, b, g, h;
  Eigen::VectorXd start;
  Eigen::MatrixXd start_covariance, q, r;
};

/// log density of the samples y [channels x N], NaN: missing, at these times under inputs u [inputs x N].
double joint_density(LinearSystem const& system, std::vector<double> const& time, Eigen::MatrixXd const& u,
                     Eigen::MatrixXd const& y) {
  auto const n = system.a.rows();
  auto const samples = static_cast<Eigen::Index>(time.size()), channels = system.h.rows();
  Eigen::MatrixXd mean(n, samples), covariance(n * samples, n * samples);
  mean.col(0) = system.start;
  covariance.setZero();
  covariance.topLeftCorner(n, n) = system.start_covariance;
  for (Eigen::Index k = 0; k + 1 < samples; ++k) {
    double const step = time[static_cast<std::size_t>(k + 1)] - time[static_cast<std::size_t>(k)];
    // Van Loan 1978: one exponential gives the transition and the covariance of what the noise adds.
    Eigen::MatrixXd block = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    block << -system.a, system.g * system.q * system.g.transpose(), Eigen::MatrixXd::Zero(n, n), system.a.transpose();
    Eigen::MatrixXd const power = (block * step).exp();
    Eigen::MatrixXd const transition = power.bottomRightCorner(n, n).transpose();
    Eigen::MatrixXd const added = transition * power.topRightCorner(n, n);
    Eigen::MatrixXd forced = Eigen::MatrixXd::Zero(n + system.b.cols(), n + system.b.cols());
    forced.topLeftCorner(n, n) = system.a;
    forced.topRightCorner(n, system.b.cols()) = system.b;
    Eigen::MatrixXd const response = (forced * step).exp().topRightCorner(n, system.b.cols());
    mean.col(k + 1) = transition * mean.col(k) + response * u.col(k);
    covariance.block((k + 1) * n, 0, n, (k + 1) * n) = transition * covariance.block(k * n, 0, n, (k + 1) * n);
    covariance.block(0, (k + 1) * n, (k + 1) * n, n) = covariance.block((k + 1) * n, 0, n, (k + 1) * n).transpose();
    covariance.block((k + 1) * n, (k + 1) * n, n, n) =
        transition * covariance.block(k * n, k * n, n, n) * transition.transpose() + added;
  }
  std::vector<std::pair<Eigen::Index, Eigen::Index>> seen;
  for (Eigen::Index k = 0; k < samples; ++k)
    for (Eigen::Index c = 0; c < channels; ++c)
      if (!std::isnan(y(c, k))) seen.emplace_back(k, c);
  auto const count = static_cast<Eigen::Index>(seen.size());
  Eigen::MatrixXd of_samples(count, count);
  Eigen::VectorXd left(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    auto const [k, c] = seen[static_cast<std::size_t>(i)];
    left(i) = y(c, k) - system.h.row(c).dot(mean.col(k));
    for (Eigen::Index j = 0; j < count; ++j) {
      auto const [l, d] = seen[static_cast<std::size_t>(j)];
      of_samples(i, j) = (system.h.row(c) * covariance.block(k * n, l * n, n, n) * system.h.row(d).transpose())(0, 0);
    }
    of_samples(i, i) += system.r(c, c);
  }
  Eigen::LLT<Eigen::MatrixXd> const factor(of_samples);
  Eigen::VectorXd const whitened = factor.matrixL().solve(left);
  double log_determinant = 0;
  for (Eigen::Index i = 0; i < count; ++i) log_determinant += 2 * std::log(factor.matrixL()(i, i));
  return -0.5 * (whitened.squaredNorm() + log_determinant + static_cast<double>(count) * std::log(2 * std::numbers::pi));
}

/// Until the language has them: an input of that name becomes the disturbance.
Model with_disturbance(Model model, std::string const& name, std::string const& intensity_parameter) {
  int input = -1;
  for (std::size_t i = 0; i < model.inputs.size(); ++i)
    if (model.inputs[i].name == name) input = static_cast<int>(i);
  int parameter = -1;
  for (std::size_t p = 0; p < model.parameters.size(); ++p)
    if (model.parameters[p].name == intensity_parameter) parameter = static_cast<int>(p);
  Graph& graph = model.graph;
  Disturbance disturbance;
  disturbance.name = name;
  disturbance.intensity = graph.leaf(LeafKind::parameter, parameter);
  model.disturbances.push_back(disturbance);
  for (State& state : model.states)
    state.derivative = graph.substitute(state.derivative, [&](NodeId leaf) -> std::optional<NodeId> {
      Node const node = graph[leaf];
      if (node.leaf_kind != LeafKind::input || node.index != input) return std::nullopt;
      return graph.leaf(LeafKind::disturbance, static_cast<int>(model.disturbances.size()) - 1);
    });
  return model;
}

struct FilterRecord {
  Experiment experiment;
  Eigen::MatrixXd u, y;
};

FilterRecord record(int samples, int channels, bool equal_steps) {
  FilterRecord result;
  result.u.resize(1, samples);
  result.y.resize(channels, samples);
  std::vector<double> force;
  double t = 0;
  for (int i = 0; i < samples; ++i) {
    result.experiment.time.push_back(t);
    t += equal_steps ? 0.02 : 0.02 * (1 + 0.4 * std::sin(1.7 * i));
    force.push_back(std::sin(0.7 * i));
    result.u(0, i) = force.back();
    for (int c = 0; c < channels; ++c) result.y(c, i) = 0.01 * std::sin(0.31 * i + c) + 0.004 * std::cos(2.1 * i * (c + 1));
  }
  result.y(0, 3) = result.y(channels - 1, 7) = std::nan("");
  result.experiment.inputs.emplace_back(InputRule::zero_order, result.experiment.time, force);
  result.experiment.inputs.emplace_back(InputRule::zero_order, result.experiment.time, force);  // not read
  result.experiment.scored.assign(static_cast<std::size_t>(samples), 1);
  for (int c = 0; c < channels; ++c) {
    result.experiment.measured.emplace_back();
    for (int i = 0; i < samples; ++i) result.experiment.measured.back().push_back(result.y(c, i));
  }
  return result;
}

std::string const filtered_text = R"(
model oscillator {
  input x [N], w [N]
  state y [m]
  initial y = 0.005, y' = 0
  parameter m [kg] ~ log_uniform(0.1, 10)
  parameter c [N s/m] ~ log_uniform(0.1, 100)
  parameter k [N/m] ~ log_uniform(10, 1000)
  parameter q [N^2 s] ~ log_uniform(1e-6, 1)
  parameter sigma [m] ~ log_uniform(1e-5, 1)
  m*y'' + c*y' + k*y = x + w
  observe displacement ~ normal(y, sd = sigma)
  observe speed [m/s] ~ normal(y' + 0.5 [1/s]*y, sd = 0.03)
}
)";

LinearSystem oscillator_system(double m, double c, double k, double q, double sigma) {
  LinearSystem system;
  system.a = Eigen::Matrix2d{{0, 1}, {-k / m, -c / m}};
  system.b = Eigen::Vector2d(0, 1 / m);
  system.g = system.b;
  system.h = Eigen::Matrix2d{{1, 0}, {0.5, 1}};
  system.start = Eigen::Vector2d(0.005, 0);
  system.start_covariance = Eigen::Matrix2d::Zero();
  system.q = Eigen::MatrixXd::Constant(1, 1, q);
  system.r = Eigen::Matrix2d{{sigma * sigma, 0}, {0, 9e-4}};
  return system;
}

double value_at(ModelTarget const& target, std::vector<double> const& declared) {
  LaneArray theta(target.dimension(), 1), values(target.dimension(), 1);
  for (int p = 0; p < target.dimension(); ++p) values(p, 0) = declared[static_cast<std::size_t>(p)];
  target.unconstrain(values, theta);
  double out = 0;
  Ledger ledger;
  target.log_likelihood(theta, {&out, 1}, ledger);
  return out;
}

TargetOptions filter_options(std::string const& method, int substeps) {
  TargetOptions options;
  options.solver.method = method;
  options.solver.substeps = substeps;
  return options;
}

TEST_CASE("the likelihood of a linear model with a disturbance is the joint normal density of its samples") {
  std::vector<double> const values = {1.3, 4, 130, 0.02, 0.004};
  LinearSystem const system = oscillator_system(1.3, 4, 130, 0.02, 0.004);
  Model const model = with_disturbance(filtered_file(filtered_text).models.front(), "w", "q");
  SUBCASE("exact steps") {
    FilterRecord const of = record(60, 2, true);
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
