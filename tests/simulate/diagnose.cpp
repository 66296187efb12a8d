// A failed solve is traced to the sub-expression that broke first, and to its time.
#include <doctest/doctest.h>

#include <cmath>

#include "simulate/experiments.hpp"
#include "simulate/simulator.hpp"
#include "simulate/systems.hpp"

using namespace sysid;

namespace {

Simulator simulator_of(SimulationSource source, int samples) {
  auto const program = std::make_shared<SimulationProgram const>(compile(std::move(source)));
  Experiment const data =
      testing::experiment(testing::uniform_times(samples, 0.01), {[](double) { return 1.0; }}, {[](double) { return 0.0; }});
  return Simulator(program, Schedule(*program, data, {.substeps = 1}));
}

/// y' = -sqrt(y), y(0) = p: reaches zero at t = 2 sqrt(p); RK4 then steps below zero. With `source.channels` empty sums.
SimulationSource draining() {
  SimulationSource source;
  Graph& g = source.graph;
  NodeId const y = g.leaf(LeafKind::state, 0);
  source.parameters = 1;
  source.initial = {g.leaf(LeafKind::parameter, 0)};
  source.derivative = {g.negate(g.unary(Operation::square_root, y))};
  source.channels = {{{y}}};
  return source;
}

}  // namespace

TEST_CASE("the root of a negative level is named, at the time the tank runs dry") {
  Simulator const simulator = simulator_of(draining(), 300);
  double const level = 1;
  std::optional<Diagnosis> const found = simulator.diagnose({&level, 1});
  REQUIRE(found);
  CHECK(simulator.program().source.graph[found->node].operation == Operation::square_root);
  // sqrt(y) falls by h/2 a step; RK4 follows the parabola exactly until the step in which it ends, t = 2.
  CHECK(found->time == doctest::Approx(2.0).epsilon(0.01));
  CHECK(found->sample >= 198);
  CHECK(found->sample <= 200);
}

TEST_CASE("a cubic that overflows is named inside the step in which it does") {
  Simulator const simulator = simulator_of(systems::duffing(), 300);
  double const parameters[] = {1, 1, 1, -1e9, 1};  // the force 1 leads beyond the barrier at once
  std::optional<Diagnosis> const found = simulator.diagnose(parameters);
  REQUIRE(found);
  Graph const& graph = simulator.program().source.graph;
  bool const cubic = graph[found->node].operation == Operation::power || graph[found->node].operation == Operation::multiply;
  CHECK(cubic);
  CHECK(found->time > 0);
}

TEST_CASE("an initial value that is not finite is named at the first sample") {
  SimulationSource source = draining();
  Graph& g = source.graph;
  source.initial = {g.call(log_function, g.leaf(LeafKind::parameter, 0))};
  NodeId const logarithm = source.initial[0];
  Simulator const simulator = simulator_of(std::move(source), 10);
  double const parameter = -1;
  std::optional<Diagnosis> const found = simulator.diagnose({&parameter, 1});
  REQUIRE(found);
  CHECK(found->node == logarithm);
  CHECK(found->sample == 0);
}

TEST_CASE("a sum that is not finite is named while the states are") {
  SimulationSource source = systems::duffing();
  Graph& g = source.graph;
  NodeId const logarithm = g.call(log_function, g.leaf(LeafKind::state, 0));  // of 0, and of negative displacements
  source.channels[0].sums.push_back(logarithm);
  Simulator const simulator = simulator_of(std::move(source), 20);
  double const parameters[] = {1, 1, 100, 0, 1};
  std::optional<Diagnosis> const found = simulator.diagnose(parameters);
  REQUIRE(found);
  CHECK(found->node == logarithm);
  LaneArray lane(5, 1), out(3, 1);
  for (int r = 0; r < 5; ++r) lane(r, 0) = parameters[r];
  Outcome outcome;
  simulator.sums(lane, out, {&outcome, 1});
  CHECK_FALSE(outcome.ok);
}

TEST_CASE("a sound solve has no diagnosis") {
  Simulator const simulator = simulator_of(systems::duffing(), 50);
  double const parameters[] = {1, 1, 100, 10, 1};
  CHECK_FALSE(simulator.diagnose(parameters));
}
