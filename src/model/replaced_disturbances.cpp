// Root by root.
#include "model/replaced_disturbances.hpp"

#include <optional>

namespace sysid {

void replace_disturbances(Model& model, std::span<NodeId const> by) {
  Graph& graph = model.graph;
  auto const replace = [&](NodeId& root) {
    root = graph.substitute(root, [&](NodeId leaf) -> std::optional<NodeId> {
      Node const& node = graph[leaf];
      if (node.leaf_kind != LeafKind::disturbance) return std::nullopt;
      return by[static_cast<std::size_t>(node.index)];
    });
  };
  for (State& state : model.states) replace(state.derivative);
  for (NodeId& memory : model.memories) replace(memory);
  for (Derived& each : model.derived) replace(each.value);
  for (LaggedQuantity& each : model.lagged_quantities) replace(each.present);
  for (Channel& channel : model.channels) {
    for (NodeId& argument : channel.noise.arguments) replace(argument);
    if (channel.noise.lower) replace(*channel.noise.lower);
    if (channel.noise.upper) replace(*channel.noise.upper);
  }
  model.disturbances.clear();
}

}  // namespace sysid
