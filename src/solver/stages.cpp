// The derivative at the stages of a step.
#include "solver/stages.hpp"

namespace sysid {

std::vector<NodeId> Stages::evaluate(std::span<NodeId const> at, Stage stage) const {
  visited.push_back({{at.begin(), at.end()}, stage});
  return graph.substitute(derivative, [&](NodeId id) -> std::optional<NodeId> {
    Node const leaf = graph[id];
    switch (leaf.leaf_kind) {
      case LeafKind::state:
        return at[static_cast<std::size_t>(leaf.index)];
      case LeafKind::input:
      case LeafKind::input_rate:
      case LeafKind::time:
        return graph.leaf(leaf.leaf_kind, leaf.index, stage, leaf.lag);
      default:
        return std::nullopt;
    }
  });
}

std::vector<NodeId> Stages::advance(std::span<NodeId const> slopes, NodeId by) const {
  std::vector<NodeId> result;
  for (std::size_t i = 0; i < slopes.size(); ++i) result.push_back(graph.add(states[i], graph.multiply(by, slopes[i])));
  return result;
}

}  // namespace sysid
