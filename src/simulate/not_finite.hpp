// Where the value of an expression is not finite.
#pragma once
#include <functional>
#include <optional>
#include <span>

#include "expression/graph.hpp"

namespace sysid {

/// The first node below the roots that is not finite, in evaluation order; values of leaves from `value_of`.
std::optional<NodeId> first_not_finite(Graph const& graph, std::span<NodeId const> roots,
                                       std::function<double(NodeId)> const& value_of);

}  // namespace sysid
