// A product taken apart: which expressions are the same up to a constant factor.
#pragma once
#include <map>
#include <optional>

#include "expression/graph.hpp"

namespace sysid {

/// constant * product of base^exponent, no exponent 0.
struct Factors {
  double constant = 1;
  std::map<NodeId, double> powers;  // bases are neither constants nor products

  /// Equal up to the constant.
  bool proportional(Factors const& other) const { return powers == other.powers; }
};

/// Products, quotients, signs and powers are multiplied out; |a|^2 is a^2 and |a b| is |a| |b|, what else stands in a function
/// stays as it is. Adds the nodes it needs to the graph.
Factors factors_of(Graph& graph, NodeId root);

}  // namespace sysid
