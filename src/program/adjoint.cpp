// Each part is one pull-back: of a step, of the sums of a channel, of the initial states.
#include "program/adjoint.hpp"

#include <algorithm>

#include "expression/pull_back.hpp"
#include "program/binding.hpp"
#include "program/tangents.hpp"
#include "solver/solver.hpp"

namespace sysid {
namespace {

std::vector<NodeId> leaves_of(Graph& graph, int first, std::size_t count) {
  std::vector<NodeId> leaves;
  for (std::size_t i = 0; i < count; ++i) leaves.push_back(graph.leaf(LeafKind::unknown, first + static_cast<int>(i)));
  return leaves;
}

/// leaves + values
std::vector<NodeId> added(Graph& graph, std::vector<NodeId> const& leaves, std::span<NodeId const> values) {
  std::vector<NodeId> result;
  for (std::size_t i = 0; i < leaves.size(); ++i) result.push_back(graph.add(leaves[i], values[i]));
  return result;
}

/// The largest parts of the roots that are known once per parameter vector, parameters themselves among them.
std::vector<NodeId> known_early(Graph const& graph, std::span<NodeId const> roots) {
  BindingTimes binding(graph);
  std::vector<NodeId> result, open(roots.begin(), roots.end());
  std::vector<bool> seen(graph.size());
  while (!open.empty()) {
    NodeId const id = open.back();
    open.pop_back();
    if (seen[id]) continue;
    seen[id] = true;
    if (binding(id) == Binding::parameter) {
      result.push_back(id);
      continue;
    }
    Node const& node = graph[id];
    NodeId const operands[] = {node.a, node.b, node.c};
    open.insert(open.end(), operands, operands + operand_count(node));
  }
  std::ranges::sort(result);
  return result;
}

}  // namespace

bool has_adjoint(SimulationSource const& source) { return has_tangents(source) && source.memories.empty() && !source.corrects(); }

bool adjoint_is_cheaper(SimulationSource const& source, std::span<int const> parameters) {
  constexpr std::ptrdiff_t most_tangents = 20;
  std::vector<NodeId> roots = source.initial;
  roots.insert(roots.end(), source.derivative.begin(), source.derivative.end());
  std::vector<NodeId> const nodes = source.graph.reachable(roots);
  std::ptrdiff_t const moving = std::ranges::count_if(nodes, [&](NodeId id) {
    Node const& node = source.graph[id];
    return node.operation == Operation::leaf && node.leaf_kind == LeafKind::parameter &&
           std::ranges::find(parameters, node.index) != parameters.end();
  });
  return source.states() * moving > most_tangents;
}

AdjointExpressions adjoint_of(SimulationSource const& source, Graph& graph, std::vector<NodeId> const& next) {
  AdjointExpressions result;
  std::size_t const states = next.size(), count = source.adjoint_by.size();
  std::vector<NodeId> by, parameters;
  for (std::size_t i = 0; i < states; ++i) by.push_back(graph.leaf(LeafKind::state, static_cast<int>(i)));
  for (int const p : source.adjoint_by) parameters.push_back(graph.leaf(LeafKind::parameter, p));
  bool const once = !source.map && find_solver(source.integrator)->exact;
  std::vector<NodeId> const values = once ? known_early(graph, next) : std::vector<NodeId>();
  std::vector<NodeId> const adjoints = leaves_of(graph, adjoint_leaf, states),
                            slopes = leaves_of(graph, slope_leaf, count + values.size());

  std::vector<NodeId> of_step = by;
  of_step.insert(of_step.end(), once ? values.begin() : parameters.begin(), once ? values.end() : parameters.end());
  std::vector<NodeId> const back = pull_back(graph, next, adjoints, of_step);
  result.step.assign(back.begin(), back.begin() + static_cast<std::ptrdiff_t>(states));
  if (once) result.slopes.assign(slopes.begin(), slopes.begin() + static_cast<std::ptrdiff_t>(count));
  std::size_t const gathered = result.slopes.size();
  for (std::size_t i = gathered; i < slopes.size(); ++i) result.slopes.push_back(graph.add(slopes[i], back[states + i - gathered]));
  result.start = added(graph, {slopes.begin(), slopes.begin() + static_cast<std::ptrdiff_t>(count)},
                       pull_back(graph, source.initial, adjoints, parameters));
  if (once) {
    result.values = pull_back(graph, values, std::span(slopes).subspan(count), parameters);
    result.start = added(graph, result.start, result.values);
  }
  by.insert(by.end(), parameters.begin(), parameters.end());
  for (ChannelSource const& channel : source.channels) {
    std::vector<NodeId> const ones(channel.sums.size(), graph.constant(1));
    std::vector<NodeId> const of = pull_back(graph, channel.sums, ones, by);
    result.observe.push_back(added(graph, adjoints, std::span(of).first(states)));
    result.direct.emplace_back(of.begin() + static_cast<std::ptrdiff_t>(states), of.end());
  }
  return result;
}

}  // namespace sysid
