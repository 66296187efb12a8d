// Reachability from what the programs compute.
#include "likelihood/read_coordinates.hpp"

#include <algorithm>

namespace sysid {
namespace {

void mark(Graph const& graph, std::vector<NodeId> const& roots, std::vector<bool>& read) {
  for (NodeId const id : graph.reachable(roots)) {
    Node const& node = graph[id];
    if (node.operation != Operation::leaf || node.leaf_kind != LeafKind::parameter) continue;
    // Rows behind the model's are states that are estimated.
    if (auto const p = static_cast<std::size_t>(node.index); p < read.size()) read[p] = true;
  }
}

void mark(SimulationSource const& source, std::vector<bool>& read) {
  std::vector<NodeId> roots;
  for (auto const* nodes : {&source.initial, &source.derivative, &source.memories, &source.constraints, &source.records})
    roots.insert(roots.end(), nodes->begin(), nodes->end());
  // Also of channels that are not measured: their sums are zero times what they read.
  for (ChannelSource const& channel : source.channels)
    for (auto const* nodes : {&channel.sums, &channel.correct}) roots.insert(roots.end(), nodes->begin(), nodes->end());
  mark(source.graph, roots, read);
}

}  // namespace

ReadByExperiment read_by(CompiledModel const& compiled, ParameterSpace const& space, int experiment) {
  std::vector<bool> read(compiled.model.parameters.size());
  mark(compiled.likelihood->source, read);
  mark(compiled.residuals->source, read);
  if (compiled.free_start) {
    std::vector<NodeId> guesses;
    for (State const& state : compiled.model.states) guesses.push_back(state.initial);
    mark(compiled.model.graph, guesses, read);
  }
  ReadByExperiment result;
  for (int p = 0; p < static_cast<int>(read.size()); ++p) {
    if (!read[static_cast<std::size_t>(p)]) continue;
    result.parameters.push_back(p);
    std::vector<int> const& of = space.coordinates_of(space.row(experiment, p));
    result.coordinates.insert(result.coordinates.end(), of.begin(), of.end());
  }
  std::sort(result.coordinates.begin(), result.coordinates.end());
  result.coordinates.erase(std::unique(result.coordinates.begin(), result.coordinates.end()), result.coordinates.end());
  return result;
}

}  // namespace sysid
