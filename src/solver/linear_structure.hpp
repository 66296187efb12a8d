// Whether equations are linear in their states with coefficients that stay the same in time, as an exact step needs them.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "expression/graph.hpp"

namespace sysid {

/// Beyond this many states the matrices of an exact step are longer as code than a record is worth.
constexpr int most_exact_states = 10;

/// Why x' = f is not x' = A x + b with a matrix A of parameters alone, and where.
struct NotLinear {
  enum class Why {
    nonlinear,  // a part of f that is not linear in the states
    varies,     // a product of states with something that changes in time: an input, its rate, time
    time,       // b reads time itself, and along a step it is no straight line for it
  };
  Why why = Why::nonlinear;
  NodeId node = 0;
};

/// derivative: one expression per state, of state, input, input_rate, time and parameter leaves. What is linear only after
/// simplification (`y*y/y`) counts as nonlinear.
std::optional<NotLinear> find_nonlinear(Graph const& graph, std::span<NodeId const> derivative);

/// Of equations that are linear in their states: the inputs that they read, or whose rates they read, other than linearly, in
/// ascending order. Along a straight line of such an input the forcing is none.
std::vector<int> inputs_not_linear(Graph const& graph, std::span<NodeId const> derivative);

}  // namespace sysid
