// What the structure of an expression shows about its sign.
#pragma once
#include "expression/graph.hpp"

namespace sysid {

/// Whether the value is never below zero whatever its leaves are: absolute values, even powers, roots, exponentials, and sums,
/// products, quotients and maxima of such. False where the structure does not show it. A NaN is no counterexample.
bool non_negative(Graph const& graph, NodeId root);

}  // namespace sysid
