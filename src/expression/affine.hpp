// Whether expressions are linear, but for a constant, in some of their leaves: as their structure shows it.
#pragma once
#include <functional>
#include <optional>
#include <span>

#include "expression/graph.hpp"

namespace sysid {

/// The first node below the roots that is not affine in the leaves that `varies` picks, all of them together: x*y is not affine in
/// x and y. Nothing where all roots are. What is affine only after simplification (`w*w/w`) counts as not affine.
std::optional<NodeId> find_not_affine(Graph const& graph, std::span<NodeId const> roots,
                                      std::function<bool(Node const&)> const& varies);

}  // namespace sysid
