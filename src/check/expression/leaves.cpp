// Leaves by kind.
#include "check/expression/leaves.hpp"

namespace sysid {

bool is_leaf(Node const& node, LeafKind kind) { return node.operation == Operation::leaf && node.leaf_kind == kind; }

std::string moving_part(Graph const& graph, NodeId root) {
  auto const reads = [&](LeafKind kind) { return graph.depends(root, [&](Node const& node) { return is_leaf(node, kind); }); };
  if (reads(LeafKind::state) || reads(LeafKind::unknown)) return "a state";
  if (reads(LeafKind::input) || reads(LeafKind::input_rate)) return "an input";
  if (reads(LeafKind::time)) return "time";
  if (reads(LeafKind::process)) return "a Gaussian process";
  if (reads(LeafKind::measured) || reads(LeafKind::previous)) return "samples";
  return {};
}

}  // namespace sysid
