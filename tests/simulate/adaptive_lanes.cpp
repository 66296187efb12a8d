// Embedded methods in lanes against closed forms: tolerance, kinks, independence of lanes, the work budget.
#include <doctest/doctest.h>

#include <cmath>

#include "core/numeric/elementary.hpp"
#include "relative.hpp"
#include "simulate/experiments.hpp"
#include "simulate/simulator.hpp"
#include "simulate/systems.hpp"

using namespace sysid;

namespace {

/// y'' + 2 d y' + w^2 y = x, from y(0) = 1 at rest; parameters d, w.
SimulationSource driven_oscillator() {
  SimulationSource source;
  Graph& g = source.graph;
  NodeId const d = g.leaf(LeafKind::parameter, 0), w = g.leaf(LeafKind::parameter, 1);
  NodeId const y = g.leaf(LeafKind::state, 0), v = g.leaf(LeafKind::state, 1);
  source.parameters = 2;
  source.inputs = 1;
  source.initial = {g.constant(1), g.constant(0)};
  source.derivative = {v, g.subtract(g.subtract(g.leaf(LeafKind::input, 0), g.multiply(g.multiply(g.constant(2), d), v)),
                                     g.multiply(g.power(w, g.constant(2)), y))};
  source.records = {y, v};
  source.integrator = "dopri5";
  return source;
}

/// Its solution for x = p + q t: particular solution (p - 2 d q/w^2)/w^2 + q t/w^2 and the free vibration that makes up for the
/// initial values.
double exact(double t, double d, double w, double p, double q) {
  double const slope = q / (w * w), level = (p - 2 * d * slope) / (w * w);
  double const wd = std::sqrt(w * w - d * d), a = 1 - level, b = (-slope + d * a) / wd;
  return level + slope * t + std::exp(-d * t) * (a * std::cos(wd * t) + b * std::sin(wd * t));
}

/// The largest error along 4 s of the oscillator under a ramp, sampled every `interval` seconds.
double error(double relative, double interval) {
  auto const program = std::make_shared<SimulationProgram const>(compile(driven_oscillator()));
  int const samples = static_cast<int>(std::lround(4 / interval)) + 1;
  std::vector<double> const times = testing::uniform_times(samples, interval);
  Experiment const record = testing::experiment(times, {[](double t) { return 0.5 + 2 * t; }}, {});
  Simulator const simulator(program, Schedule(*program, record, {.method = "dopri5", .relative = relative}));
  LaneArray parameters(2, 1), out(2 * samples, 1);
  parameters(0, 0) = 0.3;
  parameters(1, 0) = 5;
  Outcome outcome;
  simulator.records(parameters, 0, samples, out, {&outcome, 1});
  REQUIRE(outcome.ok);
  double worst = 0;
  for (int i = 0; i < samples; ++i)
    worst = std::max(worst, std::abs(out(2 * i, 0) - exact(times[static_cast<std::size_t>(i)], 0.3, 5, 0.5, 2)));
  return worst;
}

/// y'' = -sign(y) from (1/2, 0): parabolas that meet y = 0 at t = 1, 3, 5, ... with |y'| = 1; period 4. `aligned`: the kink is
/// known.
double parabola_error(double relative) {
  SimulationSource source;
  Graph& g = source.graph;
  NodeId const y = g.leaf(LeafKind::state, 0), v = g.leaf(LeafKind::state, 1);
  source.initial = {g.constant(0.5), g.constant(0)};
  source.derivative = {v, g.negate(g.unary(Operation::sign, y))};
  source.records = {y, v};
  source.integrator = "dopri5";
  auto const program = std::make_shared<SimulationProgram const>(compile(std::move(source)));
  Experiment const record = testing::experiment(testing::uniform_times(81, 0.25), {}, {});
  Simulator const simulator(program, Schedule(*program, record, {.method = "dopri5", .relative = relative, .absolute = relative}));
  LaneArray parameters(0, 1), out(2, 1);
  Outcome outcome;
  simulator.records(parameters, 80, 81, out, {&outcome, 1});
  REQUIRE(outcome.ok);
  return std::abs(out(0, 0) - 0.5);  // five periods
}

}  // namespace

TEST_CASE("the error follows the tolerance, whatever the sampling") {
  // Each step may err by relative * |y|; about 40 steps an oscillation at 1e-9, errors of an oscillator add.
  for (double const interval : {0.01, 0.1, 1.0})
    for (double const relative : {1e-5, 1e-7, 1e-9}) {
      CAPTURE(interval);
      CAPTURE(relative);
      CHECK(error(relative, interval) < 100 * relative);
    }
  CHECK(error(1e-9, 1.0) < error(1e-6, 1.0) / 100);
}

TEST_CASE("a step ends at a kink") {
  // Parabolas are exact, and ten kinks are met within 1e-9 of a step of at most 0.25, where the slope jumps by 2. Without alignment
  // the error is 1.4e-6.
  CHECK(parabola_error(1e-9) < 1e-8);
}

TEST_CASE("an adaptive lane depends on its own parameters alone") {
  SimulationSource source = systems::duffing();
  source.integrator = "dopri5";
  auto const adaptive = std::make_shared<SimulationProgram const>(compile(std::move(source)));
  int const samples = 60, width = 37;
  Experiment const record = testing::experiment(testing::uniform_times(samples, 1e-3),
                                                {[](double t) { return 10 * std::sin(700 * t) + 5 * std::sin(1900 * t); }},
                                                {[](double) { return 1e-4; }}, InputRule::cubic);
  LaneArray parameters(5, width);
  for (int w = 0; w < width; ++w) {
    // One lane in six is stiff, one diverges: neither may touch its neighbours.
    double const values[] = {1, w % 6 == 1 ? 2e5 : 20.0 + w, 1e4 * (1 + 0.1 * w), w == 9 ? -1e300 : 5e9, 1e8};
    for (int r = 0; r < 5; ++r) parameters(r, w) = values[r];
  }
  SolverSettings const solver{.method = "dopri5", .relative = 1e-7};
  LaneArray together(2 * samples, width), alone(2 * samples, 1);
  std::vector<Outcome> outcome(static_cast<std::size_t>(width));
  Simulator const wide(adaptive, Schedule(*adaptive, record, solver), {.lanes = 64});
  wide.records(parameters, 0, samples, together, outcome);
  CHECK_FALSE(outcome[9].ok);
  for (int lanes : {1, 8})
    for (int w = 0; w < width; ++w) {
      Simulator const narrow(adaptive, Schedule(*adaptive, record, solver), {.lanes = lanes});
      Outcome one;
      narrow.records(parameters.view().columns(w, 1), 0, samples, alone, {&one, 1});
      CHECK(one.ok == outcome[static_cast<std::size_t>(w)].ok);
      bool same = true;
      for (int r = 0; r < 2 * samples; ++r)
        same = same && (alone(r, 0) == together(r, w) || (std::isnan(alone(r, 0)) && std::isnan(together(r, w))));
      CHECK(same);
    }
}

TEST_CASE("a lane that needs more steps than it may take fails as step_limit") {
  auto const program = std::make_shared<SimulationProgram const>(compile(driven_oscillator()));
  Experiment const record = testing::experiment(testing::uniform_times(5, 1.0), {[](double) { return 0.0; }}, {});
  Simulator const simulator(program, Schedule(*program, record, {.method = "dopri5", .relative = 1e-8, .steps = 20}));
  LaneArray parameters(2, 2), out(2, 2);
  parameters(0, 0) = parameters(0, 1) = 0.1;
  parameters(1, 0) = 1;
  parameters(1, 1) = 300;  // 50 oscillations a sample
  std::vector<Outcome> outcome(2);
  simulator.records(parameters, 4, 5, out, outcome);
  CHECK(outcome[0].ok);
  CHECK_FALSE(outcome[1].ok);
  CHECK(outcome[1].kind == FailureClass::step_limit);
}

namespace {

/// Records of dopri5 at the times of a record without inputs, one state or more.
LaneArray trajectory(SimulationSource source, std::vector<double> const& times, double relative = 1e-9) {
  source.integrator = "dopri5";
  auto const program = std::make_shared<SimulationProgram const>(compile(std::move(source)));
  int const samples = static_cast<int>(times.size());
  Simulator const simulator(program,
                            Schedule(*program, testing::experiment(times, {}, {}), {.method = "dopri5", .relative = relative}));
  LaneArray out(samples * program->registers.records, 1);
  Outcome outcome;
  simulator.records(LaneArray(0, 1).view(), 0, samples, out, {&outcome, 1});
  CHECK(outcome.ok);
  return out;
}

}  // namespace

TEST_CASE("of two surfaces in one step only the one at its beginning is turned over there") {
  // y' = -1,  z' = |y| + 10 max(-y - 1/2, 0) from 0: y = -t, and z = t^2/2 + 5 max(t - 1/2, 0)^2.
  SimulationSource source;
  Graph& g = source.graph;
  NodeId const y = g.leaf(LeafKind::state, 0), z = g.leaf(LeafKind::state, 1);
  source.initial = {g.constant(0), g.constant(0)};
  NodeId const beyond = g.binary(Operation::maximum, g.subtract(g.negate(y), g.constant(0.5)), g.constant(0));
  source.derivative = {g.constant(-1), g.add(g.unary(Operation::absolute, y), g.multiply(g.constant(10), beyond))};
  source.records = {z};
  LaneArray const found = trajectory(std::move(source), testing::uniform_times(4, 1.0));
  CHECK(found(1, 0) == doctest::Approx(0.5 + 5 * 0.25).epsilon(1e-8));
  CHECK(found(2, 0) == doctest::Approx(2 + 5 * 2.25).epsilon(1e-8));
  CHECK(found(3, 0) == doctest::Approx(4.5 + 5 * 6.25).epsilon(1e-8));
}

TEST_CASE("an excursion to the other side that is shorter than a step is not lost") {
  // y' = 1 while |t - 0.7| < 0.1, and while |t - 1.37| < 0.15: y = 0, 0.2, 0.5, 0.5. The solver is within one of the pulses where
  // its next step, of a whole interval, would end beyond it again.
  SimulationSource source;
  Graph& g = source.graph;
  NodeId const t = g.leaf(LeafKind::time), one = g.constant(1), zero = g.constant(0);
  auto const pulse = [&](double middle, double half) {
    NodeId const from_middle = g.unary(Operation::absolute, g.subtract(t, g.constant(middle)));
    return g.select(g.binary(Operation::less, from_middle, g.constant(half)), one, zero);
  };
  source.initial = {zero};
  source.derivative = {g.add(pulse(0.7, 0.1), pulse(1.37, 0.15))};
  source.records = {g.leaf(LeafKind::state, 0)};
  LaneArray const found = trajectory(std::move(source), testing::uniform_times(4, 1.0));
  double const expected[] = {0, 0.2, 0.5, 0.5};
  for (int i = 0; i < 4; ++i) CHECK(found(i, 0) == relative(expected[i], 1e-8));
}

TEST_CASE("a ball thrown up through a surface comes back through it") {
  // y'' = -2 from y = -1/2, y' = 1.5: above 0 for t from 1/2 to 1, with 1 s between the samples; z' = 1 while y > 0.
  SimulationSource source;
  Graph& g = source.graph;
  NodeId const y = g.leaf(LeafKind::state, 0), v = g.leaf(LeafKind::state, 1);
  source.initial = {g.constant(-0.5), g.constant(1.5), g.constant(0)};
  NodeId const above = g.binary(Operation::less, g.constant(0), y);
  source.derivative = {v, g.constant(-2), g.select(above, g.constant(1), g.constant(0))};
  source.records = {g.leaf(LeafKind::state, 2)};
  // The excursion ends within the interval: whether it is seen depends on where steps end, so that they are made to end inside.
  LaneArray const found = trajectory(std::move(source), {0, 0.75, 3});
  CHECK(found(1, 0) == relative(0.25, 1e-7));
  CHECK(found(2, 0) == doctest::Approx(0.5).epsilon(1e-7));
}

TEST_CASE("what is remembered takes no part in the error of a step") {
  auto const source = [](bool remembers) {
    SimulationSource result = driven_oscillator();
    Graph& g = result.graph;
    result.parameters = result.inputs = 0;
    NodeId const y = g.leaf(LeafKind::state, 0), v = g.leaf(LeafKind::state, 1);
    result.derivative = {v, g.negate(g.add(g.multiply(g.constant(0.5), v), g.multiply(g.constant(20), y)))};
    if (!remembers) return result;
    for (int i = 2; i < 10; ++i) {
      result.initial.push_back(g.constant(1));
      result.derivative.push_back(g.constant(0));
      result.memories.push_back(y);
    }
    return result;
  };
  LaneArray const with = trajectory(source(true), testing::uniform_times(5, 1.0), 1e-5),
                  without = trajectory(source(false), testing::uniform_times(5, 1.0), 1e-5);
  for (int r = 0; r < 10; ++r) CHECK(with(r, 0) == without(r, 0));
}

TEST_CASE("a failed sub-expression is not lost in what compares it, whatever the order of operands") {
  // h' = -max(sqrt(h), 0) - 1/10 and the like: the tank is empty before t = 3, and sqrt has no value beyond.
  for (int form = 0; form < 5; ++form)
    for (char const* method : {"rk4", "dopri5", "cvode"}) {
      CAPTURE(form);
      CAPTURE(method);
      SimulationSource source;
      Graph& g = source.graph;
      NodeId const h = g.leaf(LeafKind::state, 0), zero = g.constant(0), one = g.constant(1);
      NodeId const root = g.unary(Operation::square_root, h);
      NodeId const flow = form == 0   ? g.binary(Operation::maximum, root, zero)
                          : form == 1 ? g.binary(Operation::maximum, zero, root)
                          : form == 2 ? g.unary(Operation::sign, root)
                          : form == 3 ? g.select(g.binary(Operation::less, root, g.constant(0.01)), zero, one)
                                      : g.binary(Operation::minimum, one, root);
      source.initial = {one};
      source.derivative = {g.negate(g.add(flow, g.constant(0.1)))};
      source.records = {h};
      source.integrator = method;
      auto const program = std::make_shared<SimulationProgram const>(compile(std::move(source)));
      SolverSettings solver{.method = method};
      if (solver.fixed_step()) solver.substeps = 50;
      Simulator const simulator(program, Schedule(*program, testing::experiment(testing::uniform_times(21, 1.0), {}, {}), solver));
      LaneArray out(21, 1);
      Outcome outcome;
      simulator.records(LaneArray(0, 1).view(), 0, 21, out, {&outcome, 1});
      CHECK_FALSE(outcome.ok);
    }
}
