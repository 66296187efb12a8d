// Plain evaluation, node by node.
#include "simulate/not_finite.hpp"

#include <cmath>

namespace sysid {

std::optional<NodeId> first_not_finite(Graph const& graph, std::span<NodeId const> roots,
                                       std::function<double(NodeId)> const& value_of) {
  std::vector<NodeId> const nodes = graph.reachable(roots);
  std::vector<double> const values = graph.evaluate(nodes, value_of);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (!std::isfinite(values[i]) && graph[nodes[i]].operation != Operation::constant) return nodes[i];
  return std::nullopt;
}

}  // namespace sysid
