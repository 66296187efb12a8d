// All that is simulated is looked at but the first states.
#include "diagnostics/inputs/input_leaves.hpp"

namespace sysid {

std::vector<Node> leaves_of_input(Model const& model, int input) {
  std::vector<NodeId> roots = model.residuals;
  for (State const& state : model.states) roots.push_back(state.derivative);
  for (Channel const& channel : model.channels)
    roots.insert(roots.end(), channel.noise.arguments.begin(), channel.noise.arguments.end());
  std::vector<Node> leaves;
  for (NodeId const id : model.graph.reachable(roots)) {
    Node const& node = model.graph[id];
    bool const of_inputs = node.leaf_kind == LeafKind::input || node.leaf_kind == LeafKind::input_rate;
    if (node.operation == Operation::leaf && of_inputs && node.index == input) leaves.push_back(node);
  }
  return leaves;
}

}  // namespace sysid
