// Differential-algebraic systems: which equations must be differentiated in time until the equations determine all unknowns (index
// 1).
#pragma once
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "expression/graph.hpp"

namespace sysid {

/// Unknown j, leaf unknown(j), is the highest derivative of a state with components state(first) ... state(first + order - 1), each
/// the derivative of the one before. Order 0: an algebraic unknown without components.
struct UnknownOrder {
  int order = 0;
  int first = 0;
};

/// An equation before it was differentiated: zero along every solution that starts so.
struct Constraint {
  int equation = 0;
  NodeId value = 0;
};

struct IndexOne {
  std::vector<NodeId> residuals;        // one per equation: differentiated as often as was needed
  std::vector<Constraint> constraints;  // what was lost: each differentiated equation, as it was before each time
};

/// Why that is not possible.
struct IndexFailure {
  enum class Kind {
    input_rate,     // `equation` would need the second derivative of input `index`
    algebraic,      // `equation` would have to be differentiated although it reads unknown `index`
    overdetermined  // `equation` says nothing about a state or unknown that is still open
  };
  Kind kind = Kind::overdetermined;
  int equation = 0;
  int index = 0;
};

/// Pantelides 1988: equations are matched to unknowns that they read; the equations that compete for too few unknowns are
/// differentiated in time, until all are matched. n equations 0 = residual_i, n unknowns.
std::variant<IndexOne, IndexFailure> reduce_index(Graph& graph, std::span<NodeId const> residuals,
                                                  std::span<UnknownOrder const> unknowns);

/// d(node)/dt along a solution: states go over into their derivatives, inputs into their rates, time into 1. Fails where it would
/// need the derivative of an unknown or of a rate.
std::variant<NodeId, IndexFailure> time_derivative(Graph& graph, NodeId node, std::span<UnknownOrder const> unknowns);

}  // namespace sysid
