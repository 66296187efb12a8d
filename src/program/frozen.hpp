// Expressions held on one side of each of their switching surfaces: they are smooth, so that a high-order step meets no kink.
#pragma once
#include <span>
#include <vector>

#include "expression/graph.hpp"
#include "expression/switching.hpp"

namespace sysid {

/// The roots with every branch decided by a node that is -1 or 1 for each surface, the sign of its value:
///
///   abs(a)  side*a        sign(a)  side        min(a, b), max(a, b), a < b, a <= b  by the sign of a - b
///
/// sides: one per surface. What has no surface among them (floor, a == b) stays as it is.
std::vector<NodeId> frozen(Graph& graph, std::span<NodeId const> roots, std::span<SwitchingSurface const> surfaces,
                           std::span<NodeId const> sides);

}  // namespace sysid
