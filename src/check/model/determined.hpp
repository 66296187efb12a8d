// Whether equations that are linear in their highest derivatives determine all of them.
#pragma once
#include <optional>
#include <span>

#include "expression/graph.hpp"

namespace sysid {

/// An unknown that residuals 0 = r_i, linear in the leaves unknown(0) ... unknown(n - 1), leave open whatever values the other
/// leaves take; nothing when some values determine all. By rank of d r_i / d u_j at a few points: two equations that say the same
/// thing in different words are no equal expressions.
std::optional<int> undetermined_unknown(Graph& graph, std::span<NodeId const> residuals);

}  // namespace sysid
