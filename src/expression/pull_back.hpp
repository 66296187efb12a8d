// Derivatives of many expressions at once, by as many leaves as there are: backwards through the graph (reverse accumulation).
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "expression/graph.hpp"

namespace sysid {

/// Whether all functions below the roots have derivatives.
bool knows_derivatives(Graph const& graph, std::span<NodeId const> roots);

/// For each leaf x:  sum_i weights_i * d(roots_i)/dx,  with slopes as `finite_slope` has them. A leaf may be any node: what is
/// below it counts as constant there.
///
/// Each node of the roots is passed once, whatever the number of leaves: the result has a few times as many operations as the
/// roots. Where a value on the way is infinite and its weight 0, the result is NaN, though `finite_slope` may be finite there.
std::vector<NodeId> pull_back(Graph& graph, std::span<NodeId const> roots, std::span<NodeId const> weights,
                              std::span<NodeId const> leaves);

}  // namespace sysid
