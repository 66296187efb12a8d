// One pass over the nodes below the roots; what an operation compares is its surface.
#include "expression/switching.hpp"

#include <algorithm>
#include <optional>

namespace sysid {
namespace {

bool is_condition(Operation operation) {
  switch (operation) {
    case Operation::less:
    case Operation::less_equal:
    case Operation::equal:
    case Operation::conjunction:
    case Operation::disjunction:
    case Operation::negation:
      return true;
    default:
      return false;
  }
}

std::optional<NodeId> compared(Graph& graph, Node const& node) {
  switch (node.operation) {
    case Operation::absolute:
    case Operation::sign:
    case Operation::floor:
      return node.a;
    case Operation::minimum:
    case Operation::maximum:
    case Operation::less:
    case Operation::less_equal:
    case Operation::equal:
      return graph.subtract(node.a, node.b);
    case Operation::select:
      return is_condition(graph[node.a].operation) ? std::nullopt : std::optional(node.a);
    default:
      return std::nullopt;
  }
}

}  // namespace

std::vector<SwitchingSurface> switching_surfaces(Graph& graph, std::span<NodeId const> roots) {
  std::vector<SwitchingSurface> surfaces;
  for (NodeId const id : graph.reachable(roots)) {
    Node const node = graph[id];  // a copy: the graph grows
    auto const value = compared(graph, node);
    if (!value) continue;
    SwitchingSurface surface{*value, node.operation == Operation::floor, false, false, false};
    bool reads_time = false;
    for (NodeId const below : graph.reachable({&*value, 1})) {
      Node const& leaf = graph[below];
      if (leaf.operation != Operation::leaf) continue;
      LeafKind const kind = leaf.leaf_kind;
      surface.reads_states = surface.reads_states || kind == LeafKind::state || kind == LeafKind::unknown;
      surface.reads_inputs = surface.reads_inputs || kind == LeafKind::input || kind == LeafKind::input_rate;
      reads_time = reads_time || kind == LeafKind::time;
    }
    if (!surface.reads_states && !surface.reads_inputs && !reads_time) continue;
    surface.jumps =
        node.operation != Operation::absolute && node.operation != Operation::minimum && node.operation != Operation::maximum;
    auto const known = std::find_if(surfaces.begin(), surfaces.end(), [&](SwitchingSurface const& other) {
      return other.value == surface.value && other.at_integers == surface.at_integers;
    });
    if (known == surfaces.end())
      surfaces.push_back(surface);
    else
      known->jumps = known->jumps || surface.jumps;
  }
  return surfaces;
}

}  // namespace sysid
