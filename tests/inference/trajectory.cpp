// Parts of the no-U-turn sampler: leapfrog steps, trees against their definition by recursion, metrics, step sizes.
#include "inference/nuts/trajectory.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "inference/backend/checkpoint.hpp"
#include "inference/nuts/chain.hpp"
#include "inference/nuts/number_block.hpp"
#include "linear_algebra/decompositions.hpp"
#include "relative.hpp"

namespace sysid::nuts {
namespace {

using Density = std::function<Point(std::vector<double> const&)>;

/// A banana: x_0 ~ N(0, 1), x_1 | x_0 ~ N(x_0^2, 1/2^2), and independent normals behind them.
Point banana(std::vector<double> const& theta) {
  double const bend = theta[1] - theta[0] * theta[0];
  Point point{theta, {-theta[0] + 8 * theta[0] * bend, -4 * bend}, -0.5 * theta[0] * theta[0], -2 * bend * bend};
  for (std::size_t i = 2; i < theta.size(); ++i) {
    point.gradient.push_back(-theta[i]);
    point.log_prior -= 0.5 * theta[i] * theta[i];
  }
  return point;
}

/// No density beyond a wall.
Point walled(std::vector<double> const& theta) {
  Point point = banana(theta);
  if (theta[0] < 0.9) return point;
  point.log_likelihood = -infinity;
  point.gradient.assign(theta.size(), 0);
  return point;
}

Metric some_metric(int dimension, bool dense) {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(dimension, dimension);
  covariance(0, 0) = 0.5;
  covariance(0, 1) = covariance(1, 0) = 0.3;
  return metric_of(covariance, dense);
}

/// The definition, word for word: recursion with whole lists of states (Hoffman and Gelman 2014, algorithm 3, with the weights and
/// the criterion of Betancourt 2017, app. A). It keeps every state of a part, and sums what it needs over them.
struct ByRecursion {
  struct Part {
    std::vector<Phase> states;  // in the order in which they were reached
    Point draw;
  };
  Density const& density;
  Metric const& metric;
  double step;
  int most_doublings;
  Stream stream;
  double start_energy = 0, acceptance = 0;
  int leapfrogs = 0;
  bool moved = false, diverged = false, unsolved = false, cut = false;
  std::vector<double> place = {};

  double log_weight(std::vector<Phase> const& states) const {
    double sum = 0;
    for (Phase const& state : states) sum += std::exp(start_energy - state.energy());
    return std::log(sum);
  }
  static Eigen::VectorXd momentum(Phase const& state) {
    return Eigen::Map<Eigen::VectorXd const>(state.momentum.data(), static_cast<Eigen::Index>(state.momentum.size()));
  }
  static bool turns(std::vector<Phase> const& states) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(momentum(states[0]).size());
    for (Phase const& state : states) sum += momentum(state);
    return !(sum.dot(momentum(states.front())) > 0 && sum.dot(momentum(states.back())) > 0);
  }
  /// The whole, the first with the nearest of the second, the second with the nearest of the first.
  static bool turns(std::vector<Phase> a, std::vector<Phase> b) {
    std::vector<Phase> whole = a, beside_a = a, beside_b = {a.back()};
    whole.insert(whole.end(), b.begin(), b.end());
    beside_a.push_back(b.front());
    beside_b.insert(beside_b.end(), b.begin(), b.end());
    return turns(whole) || turns(beside_a) || turns(beside_b);
  }
  std::optional<Part> build(Phase& front, bool forward, int depth) {
    if (depth == 0) {
      double const signed_step = forward ? step : -step;
      HalfStep const begun = begin_step(front, metric, signed_step);
      Phase const reached = end_step(begun, density(begun.theta), metric, signed_step);
      ++leapfrogs;
      double const rise = reached.energy() - start_energy;
      if (!(rise <= 1000)) {
        diverged = true, unsolved = !std::isfinite(rise), place = front.at.theta;
        return std::nullopt;
      }
      acceptance += std::min(1.0, std::exp(-rise));
      front = reached;
      return Part{{reached}, reached.at};
    }
    auto first = build(front, forward, depth - 1);
    if (!first) return std::nullopt;
    auto second = build(front, forward, depth - 1);
    if (!second) return std::nullopt;
    std::vector<Phase> both = first->states;
    both.insert(both.end(), second->states.begin(), second->states.end());
    bool const second_drawn = stream.uniform() < std::exp(log_weight(second->states) - log_weight(both));
    if (turns(first->states, second->states)) return std::nullopt;
    return Part{both, second_drawn ? second->draw : first->draw};
  }
  Point run(Phase const& start) {
    start_energy = start.energy();
    std::vector<Phase> states{start};  // in the order of time
    Point draw = start.at;
    for (int depth = 0; depth < most_doublings; ++depth) {
      bool const forward = stream.uniform() > 0.5;
      Phase front = forward ? states.back() : states.front();
      auto half = build(front, forward, depth);
      if (!half) return draw;
      if (stream.uniform() < std::exp(std::min(0.0, log_weight(half->states) - log_weight(states))))
        draw = half->draw, moved = true;
      if (!forward) std::reverse(half->states.begin(), half->states.end());
      bool const turned = forward ? turns(states, half->states) : turns(half->states, states);
      states.insert(forward ? states.end() : states.begin(), half->states.begin(), half->states.end());
      if (turned) return draw;
    }
    cut = true;
    return draw;
  }
};

Trajectory follow(Density const& density, StreamKey key, std::vector<double> const& start, Metric const& metric, double step,
                  int most_doublings) {
  Trajectory trajectory(key, density(start), metric, step, most_doublings);
  while (!trajectory.done()) trajectory.take(density(trajectory.asked()), metric);
  return trajectory;
}

double energy_error(double step) {
  Metric const metric = some_metric(3, true);
  Phase state{banana({0.4, -0.3, 1}), {0.7, -0.2, 0.5}};
  double const before = state.energy();
  for (int i = 0; i < static_cast<int>(std::lround(2 / step)); ++i) {
    HalfStep const begun = begin_step(state, metric, step);
    state = end_step(begun, banana(begun.theta), metric, step);
  }
  return state.energy() - before;
}

}  // namespace

TEST_CASE("a leapfrog step backwards undoes the one forwards, and its error of the energy is of second order") {
  for (bool const dense : {true, false}) {
    Metric const metric = some_metric(4, dense);
    Phase const start{banana({0.4, -0.3, 1, 2}), {0.7, -0.2, 0.5, 1.5}};
    Phase state = start;
    for (double const step : {0.3, -0.3})
      for (int i = 0; i < 20; ++i) {
        HalfStep const begun = begin_step(state, metric, step);
        state = end_step(begun, banana(begun.theta), metric, step);
      }
    for (std::size_t i = 0; i < 4; ++i) {
      CHECK(state.at.theta[i] == doctest::Approx(start.at.theta[i]).epsilon(1e-10));
      CHECK(state.momentum[i] == relative(start.momentum[i], 1e-10));
    }
  }
  double const ratio = energy_error(0.02) / energy_error(0.01);
  CHECK(ratio == doctest::Approx(4).epsilon(0.02));
}

TEST_CASE("a step keeps the volume of phase space, whatever stands for the gradient") {
  Metric const metric = some_metric(2, true);
  auto const wrong = [](std::vector<double> const& theta) {
    Point point = banana(theta);
    point.gradient = {0.3 * point.gradient[0] + std::sin(theta[1]), 1.7 * point.gradient[1] - theta[0]};
    return point;
  };
  auto const moved = [&](Eigen::Vector4d const& x) {
    Phase const from{wrong({x(0), x(1)}), {x(2), x(3)}};
    HalfStep const begun = begin_step(from, metric, 0.4);
    Phase const to = end_step(begun, wrong(begun.theta), metric, 0.4);
    return Eigen::Vector4d(to.at.theta[0], to.at.theta[1], to.momentum[0], to.momentum[1]);
  };
  Eigen::Vector4d const x(0.4, -0.3, 0.7, -0.2);
  Eigen::Matrix4d slope;
  for (int i = 0; i < 4; ++i) {
    Eigen::Vector4d const h = 1e-6 * Eigen::Vector4d::Unit(i);
    slope.col(i) = (moved(x + h) - moved(x - h)) / 2e-6;
  }
  CHECK(log_absolute_determinant(slope) == doctest::Approx(0).epsilon(1e-8));
}

TEST_CASE("a trajectory built step by step is that of the definition by recursion") {
  int longest = 0, turned_early = 0, diverged = 0, cut = 0;
  for (std::uint64_t i = 0; i < 400; ++i) {
    CAPTURE(i);
    int const dimension = 2 + static_cast<int>(i % 3);
    Metric const metric = some_metric(dimension, i % 2 == 0);
    double const step = 0.02 * static_cast<double>(1 + i % 40);
    Density const density = i % 5 == 4 ? walled : banana;
    std::vector<double> start(static_cast<std::size_t>(dimension), 0.2);
    StreamKey const key{7, Purpose::proposal, i, 3};
    int const most_doublings = 5;
    Trajectory const trajectory = follow(density, key, start, metric, step, most_doublings);

    ByRecursion reference{density, metric, step, most_doublings, Stream({7, Purpose::accept, i, 3})};
    Stream momenta(key);
    Phase begin{density(start), {}};
    for (int p = 0; p < dimension; ++p) begin.momentum.push_back(momenta.normal());
    Point const draw = reference.run(begin);
    TrajectoryInfo const info = trajectory.info();
    CHECK(info.leapfrogs == reference.leapfrogs);
    CHECK(trajectory.draw().theta == draw.theta);
    CHECK(trajectory.draw().gradient == draw.gradient);
    CHECK(info.moved == reference.moved);
    CHECK(info.cut == reference.cut);
    CHECK(info.diverged == reference.diverged);
    CHECK(info.unsolved == reference.unsolved);
    CHECK(info.place == reference.place);
    CHECK(info.acceptance == relative(reference.acceptance / reference.leapfrogs, 1e-12));
    longest = std::max(longest, info.leapfrogs);
    turned_early += !info.diverged && ((info.leapfrogs + 1) & info.leapfrogs) != 0;
    diverged += info.diverged, cut += info.cut;
  }
  // All ways to end have been met.
  CHECK(longest == 31);
  CHECK(turned_early > 10);
  CHECK(diverged > 10);
  CHECK(cut > 10);
}

TEST_CASE("a trajectory that is stored between any two steps goes on as if it had not been") {
  Metric const metric = some_metric(3, true);
  StreamKey const key{3, Purpose::proposal, 5, 11};
  std::vector<double> const start{0.2, 0.1, -1};
  Trajectory const whole = follow(banana, key, start, metric, 0.05, 6);
  REQUIRE(whole.info().leapfrogs > 20);
  Trajectory trajectory(key, banana(start), metric, 0.05, 6);
  while (!trajectory.done()) {
    NumberWriter writer;
    trajectory.visit(writer);
    NumberReader reader(writer.numbers());
    Trajectory restored;
    restored.visit(reader);
    reader.end();
    restored.resume(key, 3);
    trajectory = restored;
    trajectory.take(banana(trajectory.asked()), metric);
  }
  CHECK(trajectory.draw().theta == whole.draw().theta);
  CHECK(trajectory.info().acceptance == whole.info().acceptance);
  CHECK(trajectory.info().leapfrogs == whole.info().leapfrogs);

  NumberWriter writer;
  Trajectory(key, banana(start), metric, 0.05, 6).visit(writer);
  for (std::size_t length = 0; length < writer.numbers().size(); ++length) {
    NumberReader reader({writer.numbers().begin(), writer.numbers().begin() + static_cast<std::ptrdiff_t>(length)});
    Trajectory restored;
    CHECK_THROWS_AS(restored.visit(reader), checkpoint::Mismatch);
  }
}

TEST_CASE("a metric whitens what it measures, and its two products are each other's transpose") {
  Eigen::Matrix3d covariance;
  covariance << 4, 1, 0.5, 1, 2, -0.3, 0.5, -0.3, 1;
  for (bool const dense : {true, false}) {
    Metric const metric = metric_of(covariance, dense);
    std::vector<double> const a{0.3, -1, 2}, b{1, 0.5, -0.7};
    std::vector<double> velocity(3), force(3);
    metric.velocity(a, velocity);
    metric.force(b, force);
    double left = 0, right = 0;
    for (std::size_t i = 0; i < 3; ++i) left += b[i] * velocity[i], right += force[i] * a[i];
    CHECK(left == doctest::Approx(right).epsilon(1e-14));
    metric.whiten(velocity);
    for (std::size_t i = 0; i < 3; ++i) CHECK(velocity[i] == doctest::Approx(a[i]).epsilon(1e-13));
  }
}

namespace {

/// The metric after n independent draws of N(0, truth) in units of `start`.
Metric learnt_from(Eigen::MatrixXd const& truth, Metric start, int n) {
  Eigen::MatrixXd const factor = *cholesky(truth);
  WindowOfDraws window;
  Stream stream({21, Purpose::test, 0, 0});
  for (int i = 0; i < n; ++i) {
    Eigen::VectorXd z(truth.rows());
    for (double& v : z) v = stream.normal();
    Eigen::VectorXd const x = factor * z;
    window.add(start, {x.data(), static_cast<std::size_t>(x.size())}, true);
  }
  return window.estimate(start);
}

/// Extreme eigenvalues of truth^-1 covariance: 1 and 1 where the metric is right.
Eigen::VectorXd in_metric(Eigen::MatrixXd const& truth, Metric const& metric) {
  Eigen::Index const n = truth.rows();
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j <= i; ++j) {
      if (metric.dense) factor(i, j) = metric.factor[static_cast<std::size_t>(i * n + j)];
      if (!metric.dense && i == j) factor(i, i) = metric.factor[static_cast<std::size_t>(i)];
    }
  Eigen::MatrixXd const whitened = inverse(*cholesky(truth)) * factor;
  return symmetric_eigen(whitened * whitened.transpose()).values;
}

}  // namespace

TEST_CASE("a window of draws leaves a metric that is right as it is, and corrects one that is wrong by a factor of 100") {
  Eigen::MatrixXd truth = Eigen::MatrixXd::Identity(20, 20);
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) truth(i, j) = std::pow(0.8, std::abs(i - j)) * std::pow(10, 0.1 * (i + j));
  Metric const right = metric_of(truth, true);
  // As many as a short window has: of a plain covariance the eigenvalues would be 0.05 and 3.6.
  CHECK(learnt_from(truth, right, 50).factor == right.factor);

  for (double const factor : {0.01, 100.0}) {
    CAPTURE(factor);
    Eigen::MatrixXd wrong = truth;
    wrong.row(4) *= std::sqrt(factor), wrong.col(4) *= std::sqrt(factor);
    Metric metric = metric_of(wrong, true);
    double const before = in_metric(truth, metric).maxCoeff() / in_metric(truth, metric).minCoeff();
    metric = learnt_from(truth, metric, 400);
    Eigen::VectorXd const after = in_metric(truth, metric);
    CHECK(before > 100);
    CHECK(after.maxCoeff() / after.minCoeff() < 4);
  }
  Metric const diagonal = learnt_from(truth, metric_of(Eigen::MatrixXd::Identity(20, 20), false), 400);
  for (int i = 0; i < 20; ++i)
    CHECK(diagonal.factor[static_cast<std::size_t>(i)] == doctest::Approx(std::sqrt(truth(i, i))).epsilon(0.15));
}

TEST_CASE("a window of fewer states than directions narrows none of them") {
  Eigen::MatrixXd const truth = Eigen::MatrixXd::Identity(45, 45);
  Metric const right = metric_of(truth, true);
  CHECK(learnt_from(truth, right, 25).factor == right.factor);
  // The same where a chain stood still for half of the window.
  Metric const small = metric_of(Eigen::MatrixXd::Identity(11, 11), true);
  WindowOfDraws window;
  for (std::uint64_t i = 0; i < 25; ++i) {
    Stream stream({3, Purpose::test, i / 2, 0});
    std::vector<double> theta(11);
    for (double& v : theta) v = stream.normal();
    window.add(small, theta, i % 2 == 0);
  }
  CHECK(in_metric(Eigen::MatrixXd::Identity(11, 11), window.estimate(small)).minCoeff() > 0.05);
}

TEST_CASE("a chain that stands still teaches no metric") {
  Metric const metric = some_metric(2, true);
  WindowOfDraws window;
  for (int i = 0; i < 50; ++i) window.add(metric, std::vector<double>{0.3, 0.4}, i < 5);
  CHECK(window.estimate(metric).factor == metric.factor);
}

TEST_CASE("dual averaging finds the step of the acceptance that is asked for") {
  for (double const target : {0.6, 0.8, 0.95}) {
    StepSize step(10, target);
    for (int i = 0; i < 2000; ++i) step.learn(elementary::exp(-7 * step.step() * step.step()));
    step.freeze();
    CHECK(step.step() == relative(std::sqrt(-std::log(target) / 7), 0.03));
  }
}

TEST_CASE("burn-in is divided into windows that double, between a way in and an end for the step alone") {
  CHECK(plan_burn_in(0).ends.empty());
  CHECK(plan_burn_in(19).ends.empty());
  CHECK(plan_burn_in(500).first == 75);
  CHECK(plan_burn_in(500).ends == std::vector<std::uint64_t>{100, 150, 250, 450});
  CHECK(plan_burn_in(1000).ends == std::vector<std::uint64_t>{100, 150, 250, 450, 950});  // as in Stan
  for (std::uint64_t length = 20; length < 3000; ++length) {
    BurnIn const burn_in = plan_burn_in(length);
    REQUIRE_FALSE(burn_in.ends.empty());
    std::uint64_t at = burn_in.first;
    for (std::uint64_t const end : burn_in.ends) {
      REQUIRE(end > at);
      at = end;
    }
    REQUIRE(at < length);
  }
}

}  // namespace sysid::nuts
