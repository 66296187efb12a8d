// Leaves by kind.
#include "check/expression/leaves.hpp"

#include <vector>

namespace sysid {

bool is_leaf(Node const& node, LeafKind kind) { return node.operation == Operation::leaf && node.leaf_kind == kind; }

std::string moving_part(Graph const& graph, NodeId root) {
  auto const reads = [&](LeafKind kind) { return graph.depends(root, [&](Node const& node) { return is_leaf(node, kind); }); };
  if (reads(LeafKind::state) || reads(LeafKind::unknown)) return "a state";
  if (reads(LeafKind::disturbance)) return "a disturbance";
  if (reads(LeafKind::input) || reads(LeafKind::input_rate)) return "an input";
  if (reads(LeafKind::time)) return "time";
  if (reads(LeafKind::process)) return "a Gaussian process";
  if (reads(LeafKind::measured) || reads(LeafKind::previous)) return "samples";
  return {};
}

std::optional<Span> place_of(Graph const& graph, NodeId node) {
  std::vector<bool> holds(graph.size(), false);
  for (NodeId id = node; id < graph.size(); ++id) {
    Node const& each = graph[id];
    int const operands = operand_count(each);
    holds[id] = id == node || (operands > 0 && holds[each.a]) || (operands > 1 && holds[each.b]) || (operands > 2 && holds[each.c]);
    if (!holds[id]) continue;
    if (auto const span = graph.span(id)) return span;
  }
  return std::nullopt;
}

}  // namespace sysid
