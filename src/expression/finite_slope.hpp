// Derivatives that stay finite where a root or a power has an infinite slope.
#pragma once
#include "expression/graph.hpp"

namespace sysid {

/// Graph::differentiate, but the derivative of sqrt(a) by a, and of a^b by a for b < 1, is 0 at a = 0 instead of infinite. So the
/// derivative of |z|^(n - 1) z at z = 0 is 0, which it is for n > 1, and not 0 times infinity.
NodeId finite_slope(Graph& graph, NodeId root, NodeId leaf);

/// The change of one operation whose operands change by da, db, dc, with slopes as above: linear in these, so with w in the place
/// of one and 0 in those of the others it is w times the slope by that operand.
NodeId finite_change(Graph& graph, NodeId id, NodeId da, NodeId db, NodeId dc);

}  // namespace sysid
