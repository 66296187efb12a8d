// States that depend on no data are found by elimination, then put as parameters in the place of leaves.
#include "program/settled.hpp"

#include <algorithm>
#include <utility>

#include "solver/solver.hpp"

namespace sysid {
namespace {

/// Which states read, directly or through others, no data, at steps and at samples.
std::vector<bool> without_data(SimulationSource const& source) {
  auto const n = static_cast<std::size_t>(source.states());
  std::vector<bool> result(n, true);
  auto const reads = [&](NodeId id) {
    return source.graph.depends(id, [&](Node const& leaf) {
      if (leaf.leaf_kind == LeafKind::state) return !result[static_cast<std::size_t>(leaf.index)];
      return leaf.leaf_kind != LeafKind::parameter && leaf.leaf_kind != LeafKind::step_length &&
             leaf.leaf_kind != LeafKind::step_size;  // the same along records on which anything settles
    });
  };
  for (bool shrunk = true; std::exchange(shrunk, false);)
    for (std::size_t i = 0; i < n; ++i) {
      if (!result[i]) continue;
      bool const read = reads(source.derivative[i]) || std::ranges::any_of(source.channels, [&](ChannelSource const& channel) {
                          return !channel.correct.empty() && reads(channel.correct[i]);
                        });
      if (read) {
        result[i] = false;
        shrunk = true;
      }
    }
  return result;
}

}  // namespace

std::optional<SettledSource> settled_source(SimulationSource const& source) {
  if (source.settling.empty() || !source.records.empty() || !source.memories.empty() || !source.constraints.empty() ||
      !source.adjoint_by.empty() || source.channels.empty())
    return std::nullopt;
  if (std::ranges::any_of(source.channels, [](ChannelSource const& each) { return each.correct.empty() || each.always; }))
    return std::nullopt;
  SolverRow const* const solver = find_solver(source.integrator);
  if (!source.map && (solver == nullptr || solver->step == nullptr)) return std::nullopt;
  std::vector<bool> const still = without_data(source);
  for (SettlingState const& each : source.settling)
    if (!still[static_cast<std::size_t>(each.state)]) return std::nullopt;

  SettledSource result;
  SimulationSource& settled = result.source;
  settled = source;
  settled.settling.clear();
  Graph& graph = settled.graph;
  std::vector<NodeId> place;  // of every state: what stands for it
  for (int i = 0; i < source.states(); ++i) {
    bool const fixed = still[static_cast<std::size_t>(i)];
    place.push_back(fixed ? graph.leaf(LeafKind::parameter, settled.parameters++)
                          : graph.leaf(LeafKind::state, static_cast<int>(result.moving.size())));
    (fixed ? result.fixed : result.moving).push_back(i);
  }
  auto const placed = [&](std::vector<NodeId> const& nodes) {
    return graph.substitute(nodes, [&](NodeId leaf) -> std::optional<NodeId> {
      Node const& node = graph[leaf];
      return node.leaf_kind == LeafKind::state ? std::optional(place[static_cast<std::size_t>(node.index)]) : std::nullopt;
    });
  };
  auto const those = [](std::vector<NodeId> const& nodes, std::vector<int> const& which) {
    std::vector<NodeId> some;
    for (int const i : which) some.push_back(nodes[static_cast<std::size_t>(i)]);
    return some;
  };
  // Within a step what is fixed moves, and comes back: nothing else may read it there.
  std::vector<NodeId> const rules = those(source.derivative, result.moving);
  bool const apart = std::ranges::none_of(rules, [&](NodeId id) {
    return graph.depends(
        id, [&](Node const& leaf) { return leaf.leaf_kind == LeafKind::state && still[static_cast<std::size_t>(leaf.index)]; });
  });
  if (!apart) return std::nullopt;
  settled.derivative = placed(rules);
  settled.initial.assign(result.moving.size(), graph.constant(0));
  for (ChannelSource& channel : settled.channels) {
    channel.sums = placed(channel.sums);
    std::vector<NodeId> const corrected = placed(channel.correct);
    channel.correct = those(corrected, result.moving);
    for (int const i : result.fixed) place[static_cast<std::size_t>(i)] = corrected[static_cast<std::size_t>(i)];
  }
  return result;
}

}  // namespace sysid
