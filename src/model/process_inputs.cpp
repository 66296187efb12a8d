// Moves processes to the inputs and their arguments to the derived quantities.
#include "model/process_inputs.hpp"

#include <optional>

namespace sysid {

void processes_as_inputs(Model& model) {
  Graph& graph = model.graph;
  int const first = static_cast<int>(model.inputs.size());
  auto const replace = [&](NodeId& root) {
    root = graph.substitute(root, [&](NodeId leaf) -> std::optional<NodeId> {
      Node const node = graph[leaf];
      return node.leaf_kind == LeafKind::process ? std::optional(graph.leaf(LeafKind::input, first + node.index)) : std::nullopt;
    });
  };
  model.derived.clear();
  for (Process const& process : model.processes) {
    model.inputs.push_back(process);
    for (NodeId const argument : process.arguments) model.derived.push_back({{}, argument, true});
  }
  for (State& state : model.states) replace(state.derivative);
  for (NodeId& memory : model.memories) replace(memory);
  for (Channel& channel : model.channels)
    for (NodeId& argument : channel.noise.arguments) replace(argument);
  for (LaggedQuantity& lagged : model.lagged_quantities) replace(lagged.present);
  model.processes.clear();
}

}  // namespace sysid
