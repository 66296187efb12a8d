// Order reduction: the user's equations, written on any side and coupled, solved symbolically for their highest derivatives.
#pragma once
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "expression/graph.hpp"

namespace sysid {

/// Why a system cannot be solved for its highest derivatives; indices into the arguments of `solve_for_unknowns`.
struct ReductionFailure {
  enum class Kind {
    nonlinear,  // `equation` is not linear in `unknown`
    singular,   // no equation is left that determines `unknown`
  };
  Kind kind = Kind::nonlinear;
  int equation = 0;
  int unknown = 0;
};

/// Solves n equations 0 = residual_i, each linear in the n leaves unknown(0) ... unknown(n - 1), for these leaves.
///
///   residual = b - M u  =>  u = M^-1 b,   M_ij = - d residual_i / d u_j
///
/// by elimination on expressions: exact, whatever the parameters are, except that a pivot which is zero for some parameter values
/// gives non-finite derivatives there (counted as failed solves). Pivots are taken constant before parametric before
/// state-dependent, of constants the one that is the largest part of its equation. Returns the n solutions, free of unknowns.
std::variant<std::vector<NodeId>, ReductionFailure> solve_for_unknowns(Graph& graph, std::span<NodeId const> residuals);

}  // namespace sysid
