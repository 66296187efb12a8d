// Programs of random equations with a short record: for derivatives.
#pragma once
#include <cmath>
#include <vector>

#include "program/random_expressions.hpp"
#include "program/simulation_program.hpp"
#include "simulate/experiments.hpp"

namespace sysid::testing::random_sources {

inline constexpr int samples = 12;
inline constexpr double sample_step = 0.05;

inline double input_at(double t) { return std::sin(7 * t) + 0.3; }
inline double measured_at(double t) { return 0.4 * std::cos(3 * t); }

inline Experiment record() { return experiment(uniform_times(samples, sample_step), {&input_at}, {&measured_at}); }

/// One to three states that stay bounded, of two parameters and an input; four sums and a residual of them.
inline SimulationSource random_source(Stream& stream) {
  SimulationSource source;
  Graph& g = source.graph;
  int const states = 1 + static_cast<int>(stream.below(3));
  source.parameters = 3;
  source.inputs = 1;
  source.map = stream.below(4) == 0;
  source.integrator = stream.below(4) == 0 ? "euler" : "rk4";
  std::vector<NodeId> leaves = {g.leaf(LeafKind::input, 0), g.leaf(LeafKind::time)}, parameters;
  for (int p = 0; p < source.parameters; ++p) parameters.push_back(g.leaf(LeafKind::parameter, p));
  leaves.insert(leaves.end(), parameters.begin(), parameters.end());
  for (int i = 0; i < states; ++i) leaves.push_back(g.leaf(LeafKind::state, i));
  int const nodes = 5 + static_cast<int>(stream.below(40));
  auto const bounded = [&](NodeId e) { return g.divide(e, g.add(g.constant(1), g.multiply(e, e))); };
  for (NodeId const e : random_expressions(g, leaves, nodes, states, stream)) source.derivative.push_back(bounded(e));
  while (static_cast<int>(source.derivative.size()) < states) source.derivative.push_back(source.derivative.back());
  for (int i = 0; i < states; ++i) source.initial.push_back(bounded(random_expressions(g, parameters, 4, 1, stream).front()));
  std::vector<NodeId> observed = leaves;
  observed.push_back(g.leaf(LeafKind::measured, 0));
  source.channels = {{random_expressions(g, observed, 15, 2, stream)}};
  for (NodeId const e : random_expressions(g, leaves, 15, 2, stream)) source.channels.front().sums.push_back(e);
  source.records = random_expressions(g, observed, 15, 1, stream);
  return source;
}

}  // namespace sysid::testing::random_sources
