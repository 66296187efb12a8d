// Values at points; nothing symbolic is decided here.
#include "model/invariant.hpp"

#include <cmath>

namespace sysid {
namespace {

constexpr int points = 4;

/// Between 0.5 and 1.5, different for every leaf and point (multiples of the golden ratio lie apart).
double value_at(int index, int point) {
  double const turns = 0.6180339887498949 * (index + 1.0) + 0.4142135623730951 * (point + 1.0);
  return 0.5 + turns - std::floor(turns);
}

}  // namespace

NodeId constraint_size(Graph& graph, NodeId value) {
  NodeId sum = graph.constant(0);
  NodeId const roots[] = {value};
  for (NodeId const id : graph.reachable(roots)) {
    if (graph[id].operation != Operation::leaf || graph[id].leaf_kind == LeafKind::time) continue;
    sum = graph.add(sum, graph.unary(Operation::absolute, graph.multiply(graph.differentiate(value, id), id)));
  }
  return sum;
}

bool violated_at_start(Model const& model, Invariant const& constraint, std::span<NodeId const> initial, double tolerable) {
  Graph graph = model.graph;
  bool judged = true;
  auto const replaced = [&](NodeId root) {
    return graph.substitute(root, [&](NodeId leaf) -> std::optional<NodeId> {
      Node const& node = graph[leaf];
      if (node.leaf_kind == LeafKind::state) return initial[static_cast<std::size_t>(node.index)];
      if (node.leaf_kind != LeafKind::parameter) judged = false;
      return std::nullopt;
    });
  };
  NodeId const roots[] = {replaced(constraint.value), replaced(constraint.size)};
  if (!judged) return false;
  bool violated = false;
  for (int point = 0; point < points; ++point) {
    std::vector<double> const values = graph.evaluate(roots, [&](NodeId leaf) {
      int const index = graph[leaf].index;
      Parameter const& parameter = model.parameters[static_cast<std::size_t>(index)];
      auto const fixed = parameter.value_of_all();
      return fixed ? graph.evaluate(*fixed, [](NodeId) { return 0.0; }) : value_at(index, point);
    });
    if (!std::isfinite(values[0]) || !std::isfinite(values[1])) continue;
    if (std::abs(values[0]) <= tolerable * values[1]) return false;
    violated = true;
  }
  return violated;
}

}  // namespace sysid
