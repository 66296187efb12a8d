// The derivative of a program's sums by many parameters at once: backwards over the samples, as expressions.
#pragma once
#include <span>
#include <vector>

#include "program/simulation_program.hpp"

namespace sysid {

/// Whether a source may have an adjoint: as `has_tangents`, and nothing is remembered from sample to sample.
bool has_adjoint(SimulationSource const& source);

/// Whether it gives a gradient by these parameters for less than tangents do: where those would take more than 20 further states.
/// That is so in four lanes, as few chains have them (bench_gradient); in full lanes it would be from 8 on.
bool adjoint_is_cheaper(SimulationSource const& source, std::span<int const> parameters);

/// Place holders, of kind `unknown`: + state, the derivative by a state of what comes later; + k, the derivative by the k-th
/// parameter of `adjoint_by` so far, or by a value that is computed from parameters alone.
constexpr int adjoint_leaf = 1 << 23, slope_leaf = 1 << 24;

/// What the sections of an adjoint compute. With L the total of all sums, l_n the part of sample n, and x_(n+1) = F(x_n, p):
///
///   a_n = dF/dx' a_(n+1) + dl_n/dx,   dL/dp = sum dF/dp' a_(n+1) + dx_0/dp' a_0 + sum dl_n/dp        Griewank & Walther 2008, ch.
///   3
///
/// F is one step of the method, so this is the derivative of what the program computes, to rounding, as tangents are. Where the
/// method computes much from parameters alone before the first step, the matrices of an exact one, F reads values v(p) of that:
/// then further slopes gather dL/dv over the steps, and dv/dp' of them is taken once, with the start.
struct AdjointExpressions {
  std::vector<NodeId> step;                  // [states] dF/dx' a
  std::vector<NodeId> slopes;                // [parameters] their leaf + dF/dp' a; then [values v] their leaf + dF/dv' a
  std::vector<std::vector<NodeId>> observe;  // per channel [states] their leaf + dl/dx
  std::vector<NodeId> start;                 // [parameters] their leaf + dx_0/dp' a + dv/dp' (leaves of v)
  std::vector<NodeId> values;                // [parameters] dv/dp' (leaves of v); empty: there are none
  std::vector<std::vector<NodeId>> direct;   // per channel [parameters] dl/dp
};

/// next: the states after a step, expressions of `graph`, which has grown from the source's.
AdjointExpressions adjoint_of(SimulationSource const& source, Graph& graph, std::vector<NodeId> const& next);

}  // namespace sysid
