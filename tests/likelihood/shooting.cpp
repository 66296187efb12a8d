// Coefficients from a record in segments: against a dense least squares of the same problem, over gaps and experiments, on a
// chaotic record, and the same bytes however it is run.
#include "likelihood/segments/shooting.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "check/checking.hpp"
#include "core/numeric/random.hpp"
#include "likelihood/segments/segment_starts.hpp"
#include "linear_algebra/decompositions.hpp"
#include "relative.hpp"
#include "simulate/thread_pool.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

Experiment experiment(std::string name, double step, std::vector<std::vector<double>> measured) {
  Experiment out;
  out.name = std::move(name);
  for (std::size_t i = 0; i < measured.front().size(); ++i) out.time.push_back(step * static_cast<double>(i));
  out.scored.assign(out.time.size(), 1);
  out.measured = std::move(measured);
  return out;
}

/// y' = -r y measured in noise; two records, the first with a gap.
std::vector<Experiment> decays() {
  Stream stream({5, Purpose::test, 0, 0});
  std::vector<Experiment> all;
  for (int e = 0; e < 2; ++e) {
    std::vector<double> y;
    for (int i = 0; i < 60 + 17 * e; ++i) y.push_back((2 + e) * std::exp(-0.7 * 0.05 * i) + 0.05 * stream.normal());
    if (e == 0)
      for (std::size_t i = 20; i < 26; ++i) y[i] = std::numeric_limits<double>::quiet_NaN();
    all.push_back(experiment(e == 0 ? "a" : "b", 0.05, {y}));
  }
  return all;
}

std::shared_ptr<CompiledModel const> decay_model() {
  return compile(
      model_of("state y\ninitial y = 1\nparameter r ~ log_uniform(0.01, 100)\ny' = -r*y\nobserve o ~ normal(y, sd = 1)\n"), true,
      "rk4");
}

SegmentSimulation decay(std::vector<Segment> const& segments, ExecutionOptions execution = {}) {
  return SegmentSimulation(decay_model(), decays(), segments,
                           {{0}, {0}, 0, {.substeps = 4}, execution, make_pool(execution), nullptr});
}

ShootingPoint from(double coefficient, int states, std::size_t segments) {
  return {Eigen::VectorXd::Constant(1, coefficient), Eigen::MatrixXd::Constant(states, static_cast<Eigen::Index>(segments), 1.0)};
}

/// The same by Gauss-Newton on closed forms: rate first, then the starts.
struct Dense {
  Eigen::VectorXd unknowns;
  double squares = 0, variance_of_rate = 0;
  int count = 0;
};

Dense dense_decay(std::vector<Segment> const& segments) {
  std::vector<Experiment> const records = decays();
  auto const n = static_cast<Eigen::Index>(segments.size());
  Dense out;
  out.unknowns = Eigen::VectorXd::Constant(n + 1, 1.0);
  for (int round = 0; round < 50; ++round) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n + 1, n + 1);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n + 1);
    out.squares = 0;
    out.count = 0;
    for (Eigen::Index s = 0; s < n; ++s) {
      Segment const& segment = segments[static_cast<std::size_t>(s)];
      for (int i = 0; i < segment.count; ++i) {
        double const y =
            records[static_cast<std::size_t>(segment.experiment)].measured[0][static_cast<std::size_t>(segment.first + i)];
        if (std::isnan(y)) continue;
        double const t = 0.05 * i, e = std::exp(-out.unknowns(0) * t), start = out.unknowns(1 + s);
        Eigen::VectorXd slope = Eigen::VectorXd::Zero(n + 1);
        slope(0) = -t * start * e;
        slope(1 + s) = e;
        double const residual = start * e - y;
        normal += slope * slope.transpose();
        right -= slope * residual;
        out.squares += residual * residual;
        ++out.count;
      }
    }
    out.unknowns += solve_symmetric(normal, right);
    out.variance_of_rate = inverse(normal)(0, 0) * out.squares / (out.count - static_cast<double>(n) - 1);
  }
  return out;
}

/// Lorenz's equations with 1 % noise on each state.
Experiment lorenz(int rows, double step) {
  Eigen::Vector3d at(-8, 7, 27);
  auto const rate = [](Eigen::Vector3d const& s) {
    return Eigen::Vector3d(10 * (s(1) - s(0)), s(0) * (28 - s(2)) - s(1), s(0) * s(1) - 8.0 / 3 * s(2));
  };
  std::vector<std::vector<double>> states(3);
  for (int i = 0; i < rows; ++i) {
    for (int k = 0; k < 3; ++k) states[static_cast<std::size_t>(k)].push_back(at(k));
    double const h = step / 20;
    for (int sub = 0; sub < 20; ++sub) {
      Eigen::Vector3d const a = rate(at), b = rate(at + h / 2 * a), c = rate(at + h / 2 * b), d = rate(at + h * c);
      at += h / 6 * (a + 2 * b + 2 * c + d);
    }
  }
  Stream stream({9, Purpose::test, 0, 0});
  double const noise[] = {0.08, 0.09, 0.085};
  for (std::size_t k = 0; k < 3; ++k)
    for (double& y : states[k]) y += noise[k] * stream.normal();
  return experiment("lorenz", step, states);
}

}  // namespace

TEST_CASE("parts of a record begin where the parts of fewer halvings begin, and cover it") {
  std::vector<Experiment> const records = {experiment("a", 1, {std::vector<double>(103, 0.0)}),
                                           experiment("b", 1, {std::vector<double>(40, 0.0)})};
  for (int most = 1; most <= 4; ++most) {
    CAPTURE(most);
    std::vector<Segment> const parts = cut_into_segments(records, 10, most), fewer = cut_into_segments(records, 10, most - 1);
    int rows[2] = {0, 0};
    for (Segment const& each : parts) {
      CHECK(each.first == rows[each.experiment]);
      CHECK(each.count >= 10);
      rows[each.experiment] += each.count;
    }
    CHECK(rows[0] == 103);
    CHECK(rows[1] == 40);
    for (Segment const& each : fewer)
      CHECK(std::any_of(parts.begin(), parts.end(),
                        [&](Segment const& other) { return other.experiment == each.experiment && other.first == each.first; }));
  }
  CHECK(cut_into_segments(records, 10, 9).size() == 8 + 4);
}

TEST_CASE("a fit in segments is the dense least squares of the same problem, over experiments and a gap") {
  for (int halved : {0, 1, 3}) {
    CAPTURE(halved);
    std::vector<Segment> const segments = cut_into_segments(decays(), 7, halved);
    ShootingFit const fit = fit_by_shooting(decay(segments), from(3, 1, segments.size()));
    Dense const dense = dense_decay(segments);
    REQUIRE(fit.converged);
    CHECK(fit.determined);
    // Ends within sqrt(2e-6) of a standard deviation.
    CHECK(std::abs(fit.point.coefficients(0) - dense.unknowns(0)) < 2e-3 * std::sqrt(dense.variance_of_rate));
    CHECK(fit.squares[0] == relative(dense.squares, 1e-6));
    CHECK(fit.covariance(0, 0) == relative(dense.variance_of_rate, 1e-3));
    for (std::size_t s = 0; s < segments.size(); ++s)
      CHECK(fit.point.starts(0, static_cast<Eigen::Index>(s)) == relative(dense.unknowns(1 + static_cast<Eigen::Index>(s)), 1e-3));
    double const n = dense.count, mean = dense.squares / n;
    CHECK(fit.log_likelihood == doctest::Approx(-n / 2 * (std::log(2 * M_PI * mean) + 1)).epsilon(1e-9));
  }
}

TEST_CASE("starts alone are the best ones for the coefficients that are given") {
  std::vector<Segment> const segments = cut_into_segments(decays(), 7, 2);
  ShootingPoint point = from(0.9, 1, segments.size());
  std::vector<double> const noise = {0.05};
  fit_starts(decay(segments), point, noise);
  CHECK(point.coefficients(0) == 0.9);
  std::vector<Experiment> const records = decays();
  for (std::size_t s = 0; s < segments.size(); ++s) {
    double product = 0, square = 0;
    for (int i = 0; i < segments[s].count; ++i) {
      double const y =
          records[static_cast<std::size_t>(segments[s].experiment)].measured[0][static_cast<std::size_t>(segments[s].first + i)];
      if (std::isnan(y)) continue;
      double const e = std::exp(-0.9 * 0.05 * i);
      product += y * e;
      square += e * e;
    }
    // Ends where a step would gain less than 1e-4 of log likelihood: sqrt(2e-4) of a standard deviation.
    CHECK(std::abs(point.starts(0, static_cast<Eigen::Index>(s)) - product / square) < 0.015 * 0.05 / std::sqrt(square));
  }
}

TEST_CASE("a fit in segments is the same bytes for any number of lanes and threads") {
  std::vector<Segment> const segments = cut_into_segments(decays(), 7, 2);
  ShootingFit const one = fit_by_shooting(decay(segments), from(3, 1, segments.size()));
  for (ExecutionOptions const execution : {ExecutionOptions{1, 1}, ExecutionOptions{8, 3}, ExecutionOptions{0, 2}}) {
    ShootingFit const other = fit_by_shooting(decay(segments, execution), from(3, 1, segments.size()));
    CHECK(one.point.coefficients == other.point.coefficients);
    CHECK(one.point.starts == other.point.starts);
    CHECK(one.covariance == other.covariance);
    CHECK(one.log_evidence == other.log_evidence);
  }
}

TEST_CASE("a coefficient that moves nothing is not determined") {
  auto const compiled = compile(model_of("state y\ninitial y = 1\nparameter r ~ log_uniform(0.01, 100)\n"
                                         "parameter idle ~ normal(0, sd = 1)\ny' = -r*y + idle*0*y\n"
                                         "parameter s ~ log_uniform(0.01, 10)\nobserve o ~ normal(y, sd = s)\n"),
                                true, "rk4");
  std::vector<Segment> const segments = cut_into_segments(decays(), 7, 1);
  SegmentSimulation const simulation(compiled, decays(), segments, {{0, 1}, {1, 1, 1}, 0, {.substeps = 4}, {}, nullptr, nullptr});
  ShootingPoint const start{Eigen::VectorXd::Constant(2, 1.0),
                            Eigen::MatrixXd::Constant(1, static_cast<Eigen::Index>(segments.size()), 1.0)};
  ShootingFit const fit = fit_by_shooting(simulation, start);
  CHECK(fit.finite);
  CHECK_FALSE(fit.determined);
  CHECK(fit.point.coefficients(0) ==
        doctest::Approx(fit_by_shooting(decay(segments), from(1, 1, segments.size())).point.coefficients(0)));
}

TEST_CASE("a chaotic record gives its coefficients from segments that grow") {
  std::vector<Experiment> const records = {lorenz(1500, 0.004)};  // 6 s: neighbours part by a factor of 200
  auto const compiled = compile(
      model_of("state x, y, z\ninitial x = 1, y = 1, z = 1\nparameter a ~ normal(1, sd = 9)\nparameter b ~ normal(1, sd = 9)\n"
               "parameter c ~ normal(1, sd = 9)\nx' = a*(y - x)\ny' = x*(b - z) - y\nz' = x*y - c*z\n"
               "observe ox ~ normal(x, sd = 1)\nobserve oy ~ normal(y, sd = 1)\nobserve oz ~ normal(z, sd = 1)\n"),
      true, "rk4");
  int const most = halvings(1500, 40);
  ShootingFit fit;
  std::vector<Segment> before;
  for (int halved = most; halved >= 0; --halved) {
    std::vector<Segment> const segments = cut_into_segments(records, 40, halved);
    SegmentSimulation const simulation(compiled, records, segments,
                                       {{0, 1, 2}, {1, 1, 1}, 0, {.substeps = 2}, {}, nullptr, nullptr});
    ShootingPoint point{Eigen::Vector3d(9, 26, 3), Eigen::MatrixXd(3, static_cast<Eigen::Index>(segments.size()))};
    if (halved < most) point.coefficients = fit.point.coefficients;
    for (std::size_t s = 0; s < segments.size(); ++s)
      for (int k = 0; k < 3; ++k)
        point.starts(k, static_cast<Eigen::Index>(s)) =
            halved == most ? records[0].measured[static_cast<std::size_t>(k)][static_cast<std::size_t>(segments[s].first)]
                           : fit.point.starts(k, std::find_if(before.begin(), before.end(), [&](Segment const& each) {
                                                   return each.first == segments[s].first;
                                                 }) - before.begin());
    fit = fit_by_shooting(simulation, point);
    before = segments;
    CAPTURE(halved);
    REQUIRE(fit.converged);
  }
  double const truth[] = {10, 28, 8.0 / 3};
  for (int k = 0; k < 3; ++k) {
    double const sd = std::sqrt(fit.covariance(k, k));
    CHECK(std::abs(fit.point.coefficients(k) - truth[k]) < 4 * sd);
    CHECK(sd < 1e-3 * truth[k]);
  }
  CHECK(fit.noise_sd[0] == relative(0.08, 0.08));  // 1500 samples: 1.8 %
}
