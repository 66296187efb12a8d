// Reachability from what the residuals read, and from what switches.
#include "likelihood/differentiated.hpp"

#include <algorithm>

#include "expression/switching.hpp"
#include "program/tangents.hpp"

namespace sysid {
namespace {

bool is_estimated(Model const& model, Node const& node) {
  auto const p = static_cast<std::size_t>(node.index);
  return node.operation == Operation::leaf && node.leaf_kind == LeafKind::parameter && p < model.parameters.size() &&
         model.parameters[p].prior;
}

std::vector<int> read_by(Model const& model, SimulationSource const& source) {
  std::vector<NodeId> roots;
  for (auto const* nodes : {&source.initial, &source.derivative, &source.memories, &source.records})
    roots.insert(roots.end(), nodes->begin(), nodes->end());
  for (ChannelSource const& channel : source.channels)
    for (auto const* nodes : {&channel.sums, &channel.correct}) roots.insert(roots.end(), nodes->begin(), nodes->end());
  std::vector<int> read;
  for (NodeId const id : source.graph.reachable(roots))
    if (is_estimated(model, source.graph[id])) read.push_back(source.graph[id].index);
  std::sort(read.begin(), read.end());
  return read;
}

/// In the equations or in the noise; densities have jumps of their own that are none, such as the sign of a residual.
bool has_moving_jumps(Model const& model) {
  Graph graph = model.graph;
  std::vector<NodeId> roots = model.memories;
  for (State const& state : model.states) roots.insert(roots.end(), {state.derivative, state.initial});
  for (Channel const& channel : model.channels)
    roots.insert(roots.end(), channel.noise.arguments.begin(), channel.noise.arguments.end());
  std::vector<SwitchingSurface> const surfaces = switching_surfaces(graph, roots);
  return std::any_of(surfaces.begin(), surfaces.end(), [&](SwitchingSurface const& surface) {
    return surface.jumps && graph.depends(surface.value, [&](Node const& leaf) {
      return is_estimated(model, leaf) || leaf.leaf_kind == LeafKind::state || leaf.leaf_kind == LeafKind::previous ||
             leaf.leaf_kind == LeafKind::unknown;
    });
  });
}

}  // namespace

std::vector<int> differentiable_parameters(Model const& model, SimulationSource const& source) {
  if (!has_tangents(source) || has_moving_jumps(model)) return {};
  return read_by(model, source);
}

}  // namespace sysid
