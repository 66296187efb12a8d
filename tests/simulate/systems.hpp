// Systems the tests and benchmarks simulate, as sources of programs.
#pragma once
#include "program/simulation_program.hpp"

namespace sysid::systems {

inline NodeId number(Graph& graph, double value) { return graph.constant(value); }

/// log N(measured(channel) | location, precision)
inline NodeId normal_log_density(Graph& g, int channel, NodeId location, NodeId precision) {
  NodeId const residual = g.subtract(g.leaf(LeafKind::measured, channel), location);
  NodeId const square = g.power(residual, g.constant(2));
  NodeId const pi2 = g.constant(6.283185307179586);
  NodeId const half = g.constant(0.5);
  return g.subtract(g.multiply(half, g.call(log_function, g.divide(precision, pi2))),
                    g.multiply(g.multiply(half, precision), square));
}

/// m y'' + c y' + k y + k3 y^3 = x; parameters m, c, k, k3, precision; sums: log density, squared residuals; records: y, y'.
inline SimulationSource duffing() {
  SimulationSource source;
  Graph& g = source.graph;
  auto const p = [&](int i) { return g.leaf(LeafKind::parameter, i); };
  NodeId const y = g.leaf(LeafKind::state, 0), v = g.leaf(LeafKind::state, 1), x = g.leaf(LeafKind::input, 0);
  NodeId const cubic = g.multiply(p(3), g.power(y, g.constant(3)));
  NodeId const resistance = g.add(g.add(g.multiply(p(1), v), g.multiply(p(2), y)), cubic);
  source.parameters = 5;
  source.inputs = 1;
  source.initial = {g.constant(0), g.constant(0)};
  source.derivative = {v, g.divide(g.subtract(x, resistance), p(0))};
  NodeId const residual = g.subtract(g.leaf(LeafKind::measured, 0), y);
  source.channels = {{{normal_log_density(g, 0, y, p(4)), g.power(residual, g.constant(2))}}};
  source.records = {y, v};
  return source;
}

/// m y'' + c y' + z = x,  z' = A y' - alpha |y'| |z|^(n-1) z - beta y' |z|^n; parameters m, c, A, alpha, beta and, when exponent is
/// 0, n.
inline SimulationSource bouc_wen(double exponent) {
  SimulationSource source;
  Graph& g = source.graph;
  auto const p = [&](int i) { return g.leaf(LeafKind::parameter, i); };
  NodeId const v = g.leaf(LeafKind::state, 1), z = g.leaf(LeafKind::state, 2), x = g.leaf(LeafKind::input, 0);
  NodeId const y = g.leaf(LeafKind::state, 0);
  NodeId const n = exponent == 0 ? p(5) : g.constant(exponent);
  NodeId const abs_z = g.unary(Operation::absolute, z), abs_v = g.unary(Operation::absolute, v);
  NodeId const first = g.multiply(g.multiply(g.multiply(p(3), abs_v), g.power(abs_z, g.subtract(n, g.constant(1)))), z);
  NodeId const second = g.multiply(g.multiply(p(4), v), g.power(abs_z, n));
  source.parameters = exponent == 0 ? 6 : 5;
  source.inputs = 1;
  source.initial = {g.constant(0), g.constant(0), g.constant(0)};
  source.derivative = {v, g.divide(g.subtract(g.subtract(x, g.multiply(p(1), v)), z), p(0)),
                       g.subtract(g.subtract(g.multiply(p(2), v), first), second)};
  NodeId const residual = g.subtract(g.leaf(LeafKind::measured, 0), y);
  source.channels = {{{g.power(residual, g.constant(2))}}};
  source.records = {y, v, z};
  return source;
}

/// A chain of masses, m y_i'' + c y_i' + k (2 y_i - y_(i-1) - y_(i+1)) + k3 y_i^3 = x at the first, 0 at the others, between walls;
/// parameters m, c, k_1 ... k_n, k3.
inline SimulationSource chain(int masses) {
  SimulationSource source;
  Graph& g = source.graph;
  auto const p = [&](int i) { return g.leaf(LeafKind::parameter, i); };
  auto const y = [&](int i) { return i < 0 || i >= masses ? g.constant(0) : g.leaf(LeafKind::state, 2 * i); };
  source.parameters = masses + 3;
  source.inputs = 1;
  for (int i = 0; i < masses; ++i) {
    NodeId const v = g.leaf(LeafKind::state, 2 * i + 1);
    NodeId const stretch = g.subtract(g.multiply(g.constant(2), y(i)), g.add(y(i - 1), y(i + 1)));
    NodeId const spring = g.add(g.multiply(p(2 + i), stretch), g.multiply(p(masses + 2), g.power(y(i), g.constant(3))));
    NodeId const force = i == 0 ? g.leaf(LeafKind::input, 0) : g.constant(0);
    source.initial.insert(source.initial.end(), {g.constant(0), g.constant(0)});
    source.derivative.insert(source.derivative.end(),
                             {v, g.divide(g.subtract(g.subtract(force, g.multiply(p(1), v)), spring), p(0))});
    source.records.push_back(y(i));
  }
  source.channels = {{{g.power(g.subtract(g.leaf(LeafKind::measured, 0), y(0)), g.constant(2))}}};
  return source;
}

/// The same chain without the cubic springs, stepped exactly; parameters m, c, k_1 ... k_n, precision; sums: the log density of the
/// first mass.
inline SimulationSource linear_chain(int masses) {
  SimulationSource source = chain(masses);
  Graph& g = source.graph;
  NodeId const cubic = g.leaf(LeafKind::parameter, masses + 2);
  source.derivative = g.substitute(source.derivative, [&](NodeId leaf) -> std::optional<NodeId> {
    return leaf == cubic ? std::optional(g.constant(0)) : std::nullopt;
  });
  source.channels = {{{normal_log_density(g, 0, g.leaf(LeafKind::state, 0), cubic)}}};
  source.integrator = "exponential";
  return source;
}

}  // namespace sysid::systems
