// Constraints that hold along a solution: how large their terms are, and whether initial values satisfy them.
#pragma once
#include <span>

#include "model/model.hpp"

namespace sysid {

/// sum |d value/d q * q| over states, inputs and parameters q: the size of the terms that cancel in `value`.
NodeId constraint_size(Graph& graph, NodeId value);

/// Whether the constraint is far from zero (`tolerable` of its size: initial values are written with a few digits) wherever the
/// states are `initial` and the parameters are tried: at a few points without symmetry. Constraints that read inputs, time or
/// unknowns are not judged.
bool violated_at_start(Model const& model, Invariant const& constraint, std::span<NodeId const> initial, double tolerable = 1e-6);

}  // namespace sysid
