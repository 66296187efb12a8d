// Trajectories against closed forms: the observed order of every integrator, free and forced oscillators.
#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <string>

#include "core/numeric/elementary.hpp"
#include "simulate/experiments.hpp"
#include "simulate/simulator.hpp"

using namespace sysid;

namespace {

Function const cosine{"cos", 1, &elementary::cos, &elementary::cos_lanes, nullptr, nullptr, nullptr};

/// y'' + 2 d y' + w^2 y = cos(f t), from y(0) = p3, y'(0) = p4; parameters d, w, f, y0, v0.
SimulationSource oscillator(std::string integrator) {
  SimulationSource source;
  Graph& g = source.graph;
  auto const p = [&](int i) { return g.leaf(LeafKind::parameter, i); };
  NodeId const y = g.leaf(LeafKind::state, 0), v = g.leaf(LeafKind::state, 1);
  NodeId const force = g.call(cosine, g.multiply(p(2), g.leaf(LeafKind::time)));
  source.parameters = 5;
  source.initial = {p(3), p(4)};
  source.derivative = {v, g.subtract(g.subtract(force, g.multiply(g.multiply(g.constant(2), p(0)), v)),
                                     g.multiply(g.power(p(1), g.constant(2)), y))};
  source.records = {y, v};
  source.integrator = std::move(integrator);
  return source;
}

/// The solution: harmonic response plus the free vibration that makes up for the initial values.
double exact(double t, double d, double w, double f, double y0, double v0) {
  double const a = w * w - f * f, b = 2 * d * f, scale = 1 / (a * a + b * b);
  double const c = a * scale, s = b * scale;  // c cos(f t) + s sin(f t)
  double const wd = std::sqrt(w * w - d * d);
  double const q0 = y0 - c, q1 = (v0 - s * f + d * q0) / wd;
  return c * std::cos(f * t) + s * std::sin(f * t) + std::exp(-d * t) * (q0 * std::cos(wd * t) + q1 * std::sin(wd * t));
}

double error(std::string const& integrator, int substeps) {
  auto const program = std::make_shared<SimulationProgram const>(compile(oscillator(integrator)));
  Experiment const record = testing::experiment(testing::uniform_times(41, 0.1), {}, {});
  Simulator const simulator(program, Schedule(*program, record, {.method = integrator, .substeps = substeps}));
  LaneArray parameters(5, 1), out(2, 1);
  double const values[] = {0.1, 2.0, 3.0, 0.4, -0.3};
  for (int r = 0; r < 5; ++r) parameters(r, 0) = values[r];
  Outcome outcome;
  simulator.records(parameters, 40, 41, out, {&outcome, 1});
  CHECK(outcome.ok);
  return std::abs(out(0, 0) - exact(4.0, 0.1, 2.0, 3.0, 0.4, -0.3));
}

}  // namespace

TEST_CASE("halving the step divides the error by 2 to the order of the method") {
  for (SolverRow const& row : solvers()) {
    if (row.adaptive || row.exact) continue;
    CAPTURE(row.name);
    std::string const name(row.name);
    // Steps so small that the next term of the error series, h w or (Euler) h w^2/d smaller, is a twentieth at most.
    int const substeps = 4 << (2 * (4 - row.order));
    double const observed = std::log2(error(name, substeps) / error(name, 2 * substeps));
    CHECK(std::abs(observed - row.order) < 0.1);
  }
}

TEST_CASE("a free damped oscillation follows its closed form at every sample") {
  auto const program = std::make_shared<SimulationProgram const>(compile(oscillator("rk4")));
  // Uneven samples: the step is data, not part of the program.
  std::vector<double> time;
  for (int i = 0; i < 60; ++i) time.push_back(0.05 * i + (i % 3) * 0.01);
  Experiment const record = testing::experiment(time, {}, {});
  Simulator const simulator(program, Schedule(*program, record, {.substeps = 4}));
  int const width = 10;
  LaneArray parameters(5, width), out(2 * 60, width);
  for (int w = 0; w < width; ++w) {
    double const values[] = {0.05 * w, 1.0 + 0.2 * w, 2.5, 0.3, 0.1 * w};
    for (int r = 0; r < 5; ++r) parameters(r, w) = values[r];
  }
  std::vector<Outcome> outcome(width);
  simulator.records(parameters, 0, 60, out, outcome);
  for (int w = 0; w < width; ++w) {
    double worst = 0;
    for (int i = 0; i < 60; ++i)
      worst = std::max(worst, std::abs(out(2 * i, w) - exact(time[static_cast<std::size_t>(i)], parameters(0, w), parameters(1, w),
                                                             2.5, 0.3, 0.1 * w)));
    // Global error of RK4 is below t (h w)^4 w / 120 times the amplitude: 3 * (0.015 * 2.8)^4 * 2.8 / 120 = 2e-7.
    CHECK(worst < 2e-7);
  }
}
