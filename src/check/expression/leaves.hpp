// What the leaves below an expression are.
#pragma once
#include <optional>
#include <string>

#include "expression/graph.hpp"

namespace sysid {

bool is_leaf(Node const& node, LeafKind kind);

/// What an expression reads that it may not, in words; empty when it reads constants and parameters only.
std::string moving_part(Graph const& graph, NodeId root);

/// Of a node, else of the smallest expression around it that has a place in the text.
std::optional<Span> place_of(Graph const& graph, NodeId node);

}  // namespace sysid
