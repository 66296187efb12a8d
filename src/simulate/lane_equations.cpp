// Inputs of the kernels are written where the scalar executor reads them.
#include "simulate/lane_equations.hpp"

#include <algorithm>
#include <cmath>

#include "core/text/diagnostic.hpp"
#include "program/embedded.hpp"
#include "program/interpreter/executor.hpp"
#include "simulate/not_finite.hpp"

namespace sysid {

LaneEquations::LaneEquations(SimulationProgram const& program, Schedule const& schedule)
    : program_(program),
      schedule_(schedule),
      rates_(static_cast<std::size_t>(program.equations.rates.registers)),
      jacobian_(static_cast<std::size_t>(program.equations.jacobian.registers)) {}

void LaneEquations::set_parameters(ConstLanes parameters, int lane) {
  for (int p = 0; p < program_.equations.parameters; ++p)
    rates_[static_cast<std::size_t>(p)] = jacobian_[static_cast<std::size_t>(p)] = parameters(p, lane);
}

void LaneEquations::set_interval(int sample) {
  interval_ = std::min(sample, schedule_.samples() - 2);
  beyond_ = sample > interval_;
}

double LaneEquations::data(UniformLeaf const& leaf, double time) const {
  if (leaf.kind == LeafKind::time) return schedule_.time(0) + time;
  double const begin = this->time(interval_), end = this->time(interval_ + 1);
  if (leaf.kind == LeafKind::step_length) return mean_step(schedule_.experiment().time);
  if (leaf.kind == LeafKind::interval) {  // what is held from sample to sample reads how long that is
    if (static_cast<IntervalData>(leaf.index) != IntervalData::length)
      throw InternalError("equations read what only the control of a step has");
    return end - begin;
  }
  InputSignal const& signal = schedule_.experiment().inputs[static_cast<std::size_t>(leaf.index)];
  // Nothing follows the last sample that its held value could be the limit of.
  if (beyond_ && leaf.kind == LeafKind::input) return signal.sample(interval_ + 1);
  double const s = std::clamp((time - begin) / (end - begin), 0.0, 1.0);
  return leaf.kind == LeafKind::input ? signal.value(interval_, s) : signal.rate(interval_, s);
}

bool LaneEquations::run(Kernel const& kernel, double time, double const* states, std::vector<double>& registers, double* out) {
  EquationKernels const& equations = program_.equations;
  double* place = std::copy(states, states + equations.states, registers.data() + equations.parameters);
  for (UniformLeaf const& leaf : equations.data) *place++ = data(leaf, time);
  run_scalar(kernel.code, kernel.constants.data(), registers.data());
  bool finite = true;
  for (std::size_t r = 0; r < kernel.results.size(); ++r) {
    Operand const result = kernel.results[r];
    out[r] = result.place == OperandPlace::uniform ? kernel.constants[result.index] : registers[result.index];
    finite = finite && std::isfinite(out[r]);
  }
  return finite;
}

bool LaneEquations::rates(double time, double const* states, double* out) {
  return run(program_.equations.rates, time, states, rates_, out);
}

bool LaneEquations::jacobian(double time, double const* states, double* out) {
  return run(program_.equations.jacobian, time, states, jacobian_, out);
}

NodeId LaneEquations::equation(int state) const {
  auto const i = static_cast<std::size_t>(state), differential = program_.source.derivative.size();
  return i < differential ? program_.source.derivative[i] : program_.source.constraints[i - differential];
}

std::optional<NodeId> LaneEquations::not_finite(double time, std::span<double const> states) {
  Graph const& graph = program_.source.graph;
  std::vector<NodeId> roots = program_.source.derivative;
  roots.insert(roots.end(), program_.source.constraints.begin(), program_.source.constraints.end());
  return first_not_finite(graph, roots, [&](NodeId id) {
    Node const& node = graph[id];
    if (node.leaf_kind == LeafKind::parameter) return rates_[static_cast<std::size_t>(node.index)];
    if (node.leaf_kind == LeafKind::state) return states[static_cast<std::size_t>(node.index)];
    return data({node.leaf_kind, node.index, node.stage}, time);
  });
}

}  // namespace sysid
