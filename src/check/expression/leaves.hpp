// What the leaves below an expression are.
#pragma once
#include <string>

#include "expression/graph.hpp"

namespace sysid {

bool is_leaf(Node const& node, LeafKind kind);

/// What an expression reads that it may not, in words; empty when it reads constants and parameters only.
std::string moving_part(Graph const& graph, NodeId root);

}  // namespace sysid
