// Where a failed solve broke: it is run again in one lane. Fixed steps are evaluated as written, and the first sub-expression that
// is not finite is named; other solvers say themselves where they gave up.
#include <algorithm>
#include <cmath>

#include "core/system/interrupt.hpp"
#include "program/kernel.hpp"
#include "simulate/block.hpp"
#include "simulate/not_finite.hpp"
#include "simulate/simulator.hpp"

namespace sysid {
namespace {

std::optional<std::size_t> not_finite(std::vector<double> const& values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i])) return i;
  return std::nullopt;
}

/// One lane of one simulation.
class Solve {
 public:
  Solve(Simulator const& simulator, std::span<double const> parameters)
      : simulator_(simulator), program_(simulator.program()), schedule_(simulator.schedule()), parameters_(parameters) {
    for (NodeId const id : program_.graph.reachable(program_.next))
      if (program_.graph[id].operation == Operation::leaf) leaves_.push_back(id);
    next_ = compile_kernel(program_.graph, leaves_, program_.next);
  }

  std::optional<Diagnosis> run() {
    Graph const& graph = program_.source.graph;
    std::vector<NodeId> const& initial = program_.source.initial;
    auto const at_start = [&](NodeId id) { return leaf(graph[id], 0, -1, {}); };
    if (auto const node = first_not_finite(graph, initial, at_start)) return Diagnosis{*node, schedule_.time(0), 0};
    states_ = graph.evaluate(initial, at_start);
    if (!schedule_.solver().fixed_step()) return run_solver();
    for (int sample = 0; sample < schedule_.last_summed() && !simulator_.stopped(); ++sample) {
      if (auto const node = look_at_sums(sample)) return Diagnosis{*node, schedule_.time(sample), sample};
      carry(sample);
      for (int substep = 0; substep < schedule_.solver().substeps && sample + 1 < schedule_.last_summed(); ++substep)
        if (auto const found = step(sample, substep)) return found;
    }
    return std::nullopt;
  }

 private:
  std::optional<Diagnosis> run_solver() {
    Block block(program_, schedule_, choose_executor(1), 1, native::LoopKind::observe, simulator_.options().stopped);
    LaneArray parameters(program_.registers.parameters, 1);
    for (int p = 0; p < parameters.rows(); ++p) parameters(p, 0) = parameters_[static_cast<std::size_t>(p)];
    block.set_parameters(parameters);
    block.start();
    for (int sample = 0; sample < schedule_.last_summed() && !simulator_.stopped(); ++sample) {
      if (sample > 0) {
        block.pass(sample - 1);
        block.step(sample - 1);
      }
      if (auto const failure = block.step_failure(0)) {
        if (!failure->node) return std::nullopt;
        return Diagnosis{*failure->node, schedule_.time(0) + failure->time, sample, failure->kind};
      }
      for (std::size_t s = 0; s < states_.size(); ++s) states_[s] = block.states()(static_cast<int>(s), 0);
      if (auto const node = look_at_sums(sample)) return Diagnosis{*node, schedule_.time(sample), sample};
    }
    return std::nullopt;
  }

  double leaf(Node const& node, int sample, int substep, std::vector<double> const& states) const {
    if (node.leaf_kind == LeafKind::parameter) return parameters_[static_cast<std::size_t>(node.index)];
    if (node.leaf_kind == LeafKind::state) return states[static_cast<std::size_t>(node.index)];
    UniformLeaf const uniform{node.leaf_kind, node.index, node.stage, node.lag};
    return substep < 0 ? schedule_.at_sample(uniform, sample) : schedule_.at_step(uniform, sample, substep);
  }

  /// Leaves the states as the samples have corrected them.
  std::optional<NodeId> look_at_sums(int sample) {
    Graph const& graph = program_.source.graph;
    for (std::size_t c = 0; c < program_.source.channels.size(); ++c) {
      if (!schedule_.summed(static_cast<int>(c), sample)) continue;
      ChannelSource const& channel = program_.source.channels[c];
      auto const value_of = [&](NodeId id) { return leaf(graph[id], sample, -1, states_); };
      for (auto const* nodes : {&channel.sums, &channel.correct})
        if (auto const node = first_not_finite(graph, *nodes, value_of)) return node;
      if (!channel.correct.empty()) states_ = graph.evaluate(channel.correct, value_of);
    }
    return std::nullopt;
  }

  void carry(int sample) {
    Graph const& graph = program_.source.graph;
    std::vector<double> const values =
        graph.evaluate(program_.source.memories, [&](NodeId id) { return leaf(graph[id], sample, -1, states_); });
    std::copy(values.begin(), values.end(), states_.end() - static_cast<std::ptrdiff_t>(values.size()));
  }

  std::optional<Diagnosis> step(int sample, int substep) {
    std::vector<double> inputs, next(states_.size());
    for (NodeId const id : leaves_) inputs.push_back(leaf(program_.graph[id], sample, substep, states_));
    run_scalar(next_, inputs, next);
    if (std::optional<std::size_t> const state = not_finite(next)) return look_into(sample, substep, *state);
    states_ = std::move(next);
    return std::nullopt;
  }

  /// The evaluations of the derivative within the step that made `failed` not finite.
  Diagnosis look_into(int sample, int substep, std::size_t failed) const {
    Graph const& graph = program_.source.graph;
    auto const at = [&](Stage stage, NodeId node) {
      return Diagnosis{node, schedule_.at_step({LeafKind::time, 0, stage}, sample, substep), sample};
    };
    if (program_.source.map) {
      auto const node = first_not_finite(graph, program_.source.derivative, [&](NodeId id) {
        return leaf(graph[id], sample, program_.source.stepped ? substep : -1, states_);
      });
      return at(Stage::begin, node.value_or(program_.source.derivative[failed]));
    }
    for (StageVisit const& visit : program_.visited) {
      std::vector<double> const states =
          program_.graph.evaluate(visit.states, [&](NodeId id) { return leaf(program_.graph[id], sample, substep, states_); });
      if (std::optional<std::size_t> const state = not_finite(states)) return at(visit.stage, program_.source.derivative[*state]);
      auto const value_of = [&](NodeId id) {
        Node node = graph[id];
        node.stage = visit.stage;
        return leaf(node, sample, substep, states);
      };
      if (auto const node = first_not_finite(graph, program_.source.derivative, value_of)) return at(visit.stage, *node);
    }
    return at(Stage::end, program_.source.derivative[failed]);
  }

  Simulator const& simulator_;
  SimulationProgram const& program_;
  Schedule const& schedule_;
  std::span<double const> parameters_;
  std::vector<NodeId> leaves_;
  Kernel next_;
  std::vector<double> states_;
};

}  // namespace

std::optional<Diagnosis> Simulator::diagnose(std::span<double const> parameters) const {
  auto const found = Solve(*this, parameters).run();
  if (options_.throws && stopped()) throw Interrupted();
  return found;
}

}  // namespace sysid
