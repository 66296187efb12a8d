// Consistent values of several algebraic states at once: against closed forms, with rows that have to be exchanged.
#include "simulate/algebraic_states.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "simulate/experiments.hpp"

using namespace sysid;

namespace {

/// 0 = A z - A (1, 2, ..., n) for n algebraic states z beside one differential state that does not move.
SimulationSource linear(std::vector<std::vector<double>> const& matrix) {
  SimulationSource source;
  Graph& g = source.graph;
  int const n = static_cast<int>(matrix.size());
  source.initial = {g.constant(1)};
  source.derivative = {g.constant(0)};
  for (auto const& row : matrix) {
    NodeId sum = g.constant(0);
    for (int j = 0; j < n; ++j) {
      NodeId const z = g.leaf(LeafKind::state, 1 + j);
      sum = g.add(sum, g.multiply(g.constant(row[static_cast<std::size_t>(j)]), g.subtract(z, g.constant(j + 1))));
    }
    source.initial.push_back(g.constant(0));
    source.constraints.push_back(sum);
    source.records.push_back(g.leaf(LeafKind::state, static_cast<int>(source.initial.size()) - 1));
  }
  source.integrator = "ida";
  return source;
}

/// The algebraic states that Newton's method finds, started at zero.
std::vector<double> solved(SimulationSource const& source, SolverSettings const& solver) {
  SimulationProgram const program = compile(source);
  Schedule const schedule(program, testing::experiment(testing::uniform_times(2, 1), {}, {}), solver);
  LaneEquations equations(program, schedule);
  LaneArray const none(0, 1);
  equations.set_parameters(none, 0);
  equations.set_interval(0);
  std::vector<double> states(source.initial.size(), 0.0);
  CHECK_FALSE(AlgebraicStates(equations, solver).solve(0, states));
  return states;
}

}  // namespace

TEST_CASE("linear constraints are solved whatever the order of their rows") {
  // A bob of 1/2 kg on a rod of 0.8 m at several angles: forces along x and y, and the length of the rod differentiated twice.
  for (double const angle : {-1.4, -0.7, -0.1, 0.3, 0.45, 0.9, 1.2, 2.0, 2.8}) {
    double const s = std::sin(angle), c = -std::cos(angle);
    std::vector<std::vector<double>> rows = {{-0.5, 0, -s}, {0, -0.5, -c}, {-1.6 * s, -1.6 * c, 0}};
    std::sort(rows.begin(), rows.end());
    do {
      CAPTURE(angle);
      std::vector<double> const states = solved(linear(rows), {.method = "ida", .relative = 1e-6});
      for (std::size_t j = 1; j < states.size(); ++j) CHECK(std::abs(states[j] - static_cast<double>(j)) < 1e-6);
    } while (std::next_permutation(rows.begin(), rows.end()));
  }
}

TEST_CASE("consistent values are found at tolerances near rounding") {
  std::vector<std::vector<double>> const rows = {{1, 2, 3}, {4, 5, 6}, {7, 8, 10}};
  std::vector<double> const states = solved(linear(rows), {.method = "ida", .relative = 1e-13});
  for (std::size_t j = 1; j < states.size(); ++j) CHECK(std::abs(states[j] - static_cast<double>(j)) < 1e-12);
}
