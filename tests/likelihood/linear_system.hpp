// Linear models with disturbances as one joint normal distribution, which shares no code with a filter: matrix exponentials by
// Eigen, one covariance matrix, one Cholesky factor.
#pragma once
#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <string>
#include <unsupported/Eigen/MatrixFunctions>
#include <utility>
#include <vector>

#include "likelihood/model_target.hpp"
#include "load/load.hpp"

namespace sysid::test {

inline CheckedFile filtered_file(std::string const& text) {
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
  bool held = false;  // w keeps its value from sample to sample, and q is its covariance
};

/// The same with the integral of each disturbance as a further state.
inline LinearSystem with_integrals(LinearSystem const& system) {
  auto const n = system.a.rows(), noises = system.g.cols();
  LinearSystem result = system;
  result.a = Eigen::MatrixXd::Zero(n + noises, n + noises);
  result.a.topLeftCorner(n, n) = system.a;
  result.b = Eigen::MatrixXd::Zero(n + noises, system.b.cols());
  result.b.topRows(n) = system.b;
  result.g = Eigen::MatrixXd::Zero(n + noises, noises);
  result.g.topRows(n) = system.g;
  result.g.bottomRows(noises).setIdentity();
  result.h = Eigen::MatrixXd::Zero(system.h.rows(), n + noises);
  result.h.leftCols(n) = system.h;
  result.start = Eigen::VectorXd::Zero(n + noises);
  result.start.head(n) = system.start;
  result.start_covariance = Eigen::MatrixXd::Zero(n + noises, n + noises);
  result.start_covariance.topLeftCorner(n, n) = system.start_covariance;
  return result;
}

/// Of the states at all samples [n N], and of the samples y [channels x N] that there are (NaN: missing).
struct JointNormal {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
  Eigen::MatrixXd observation;  // y = observation * states + noise
  Eigen::VectorXd left;         // y - E y
  Eigen::MatrixXd of_samples;   // their covariance
};

inline JointNormal joint_normal(LinearSystem const& system, std::vector<double> const& time, Eigen::MatrixXd const& u,
                                Eigen::MatrixXd const& y) {
  auto const n = system.a.rows();
  auto const samples = static_cast<Eigen::Index>(time.size());
  JointNormal joint;
  joint.mean = Eigen::VectorXd::Zero(n * samples);
  Eigen::MatrixXd& covariance = joint.covariance = Eigen::MatrixXd::Zero(n * samples, n * samples);
  joint.mean.head(n) = system.start;
  covariance.topLeftCorner(n, n) = system.start_covariance;
  for (Eigen::Index k = 0; k + 1 < samples; ++k) {
    double const step = time[static_cast<std::size_t>(k + 1)] - time[static_cast<std::size_t>(k)];
    // Van Loan 1978: one exponential gives the transition and the covariance of what the noise adds.
    Eigen::MatrixXd block = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    block << -system.a, system.g * system.q * system.g.transpose(), Eigen::MatrixXd::Zero(n, n), system.a.transpose();
    Eigen::MatrixXd const power = (block * step).exp();
    Eigen::MatrixXd const transition = power.bottomRightCorner(n, n).transpose();
    auto const response_to = [&](Eigen::MatrixXd const& gain) -> Eigen::MatrixXd {
      Eigen::MatrixXd forced = Eigen::MatrixXd::Zero(n + gain.cols(), n + gain.cols());
      forced.topLeftCorner(n, n) = system.a;
      forced.topRightCorner(n, gain.cols()) = gain;
      return (forced * step).exp().topRightCorner(n, gain.cols());
    };
    Eigen::MatrixXd const response = response_to(system.b), of_noise = response_to(system.g);
    Eigen::MatrixXd added = transition * power.topRightCorner(n, n);
    if (system.held) added = of_noise * system.q * of_noise.transpose();
    joint.mean.segment((k + 1) * n, n) = transition * joint.mean.segment(k * n, n) + response * u.col(k);
    covariance.block((k + 1) * n, 0, n, (k + 1) * n) = transition * covariance.block(k * n, 0, n, (k + 1) * n);
    covariance.block(0, (k + 1) * n, (k + 1) * n, n) = covariance.block((k + 1) * n, 0, n, (k + 1) * n).transpose();
    covariance.block((k + 1) * n, (k + 1) * n, n, n) =
        transition * covariance.block(k * n, k * n, n, n) * transition.transpose() + added;
  }
  std::vector<std::pair<Eigen::Index, Eigen::Index>> seen;
  for (Eigen::Index k = 0; k < samples; ++k)
    for (Eigen::Index c = 0; c < system.h.rows(); ++c)
      if (!std::isnan(y(c, k))) seen.emplace_back(k, c);
  auto const count = static_cast<Eigen::Index>(seen.size());
  joint.observation = Eigen::MatrixXd::Zero(count, n * samples);
  Eigen::VectorXd values(count), noise(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    auto const [k, c] = seen[static_cast<std::size_t>(i)];
    joint.observation.row(i).segment(k * n, n) = system.h.row(c);
    values(i) = y(c, k);
    noise(i) = system.r(c, c);
  }
  joint.left = values - joint.observation * joint.mean;
  joint.of_samples = joint.observation * covariance * joint.observation.transpose();
  joint.of_samples.diagonal() += noise;
  return joint;
}

/// log density of the samples y [channels x N], NaN: missing, at these times under inputs u [inputs x N].
inline double joint_density(LinearSystem const& system, std::vector<double> const& time, Eigen::MatrixXd const& u,
                            Eigen::MatrixXd const& y) {
  JointNormal const joint = joint_normal(system, time, u, y);
  Eigen::LLT<Eigen::MatrixXd> const factor(joint.of_samples);
  Eigen::VectorXd const whitened = factor.matrixL().solve(joint.left);
  double log_determinant = 0;
  for (Eigen::Index i = 0; i < whitened.size(); ++i) log_determinant += 2 * std::log(factor.matrixL()(i, i));
  return -0.5 * (whitened.squaredNorm() + log_determinant + static_cast<double>(whitened.size()) * std::log(2 * std::numbers::pi));
}

/// Mean and sd, given all samples, of linear functions of the states at all samples [functions x n N].
inline std::pair<Eigen::VectorXd, Eigen::VectorXd> posterior_of(JointNormal const& joint, Eigen::MatrixXd const& functions) {
  Eigen::LLT<Eigen::MatrixXd> const factor(joint.of_samples);
  Eigen::MatrixXd const with_samples = functions * joint.covariance * joint.observation.transpose();
  Eigen::VectorXd const mean = functions * joint.mean + with_samples * factor.solve(joint.left);
  Eigen::MatrixXd const left =
      functions * joint.covariance * functions.transpose() - with_samples * factor.solve(with_samples.transpose());
  return {mean, left.diagonal().cwiseMax(0).cwiseSqrt()};
}

/// Until the language has them: an input of that name becomes the disturbance.
inline Model with_disturbance(Model model, std::string const& name, std::string const& intensity_parameter) {
  int input = -1;
  for (std::size_t i = 0; i < model.inputs.size(); ++i)
    if (model.inputs[i].name == name) input = static_cast<int>(i);
  int parameter = -1;
  for (std::size_t p = 0; p < model.parameters.size(); ++p)
    if (model.parameters[p].name == intensity_parameter) parameter = static_cast<int>(p);
  Graph& graph = model.graph;
  Disturbance disturbance;
  disturbance.name = name;
  disturbance.unit = model.inputs[static_cast<std::size_t>(input)].unit;
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

inline FilterRecord record(int samples, int channels, bool equal_steps) {
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

inline std::string const filtered_text = R"(
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

inline LinearSystem oscillator_system(double m, double c, double k, double q, double sigma) {
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

inline double value_at(ModelTarget const& target, std::vector<double> const& declared) {
  LaneArray theta(target.dimension(), 1), values(target.dimension(), 1);
  for (int p = 0; p < target.dimension(); ++p) values(p, 0) = declared[static_cast<std::size_t>(p)];
  target.unconstrain(values, theta);
  double out = 0;
  Ledger ledger;
  target.log_likelihood(theta, {&out, 1}, ledger);
  return out;
}

inline TargetOptions filter_options(std::string const& method, int substeps) {
  TargetOptions options;
  options.solver.method = method;
  options.solver.substeps = substeps;
  return options;
}

}  // namespace sysid::test
