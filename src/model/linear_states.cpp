// Derivatives and means of channels are affine; other arguments of the noise do not move.
#include "model/linear_states.hpp"

#include <vector>

#include "expression/affine.hpp"

namespace sysid {

std::optional<NodeId> find_nonlinear_in_states(Model const& model) {
  auto const varies = [](Node const& leaf) {
    return leaf.operation == Operation::leaf && (leaf.leaf_kind == LeafKind::state || leaf.leaf_kind == LeafKind::disturbance);
  };
  std::vector<NodeId> roots;
  for (State const& state : model.states) roots.push_back(state.derivative);
  for (Channel const& channel : model.channels) roots.push_back(channel.noise.arguments.front());
  if (auto const found = find_not_affine(model.graph, roots, varies)) return found;
  for (Channel const& channel : model.channels)
    for (std::size_t a = 1; a < channel.noise.arguments.size(); ++a)
      if (model.graph.depends(channel.noise.arguments[a], varies)) return channel.noise.arguments[a];
  return std::nullopt;
}

}  // namespace sysid
