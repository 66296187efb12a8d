// Where an expression has kinks and jumps: the surfaces at which abs, sign, min, max, floor and comparisons change their branch.
#pragma once
#include <span>
#include <vector>

#include "expression/graph.hpp"

namespace sysid {

/// An expression is smooth as long as none of its surfaces is crossed; solvers end their steps on them.
struct SwitchingSurface {
  NodeId value = 0;           // crosses zero where the expression switches
  bool at_integers = false;   // the argument of a floor: it switches wherever `value` crosses an integer
  bool reads_states = false;  // else time and inputs alone move it: where it is crossed is known before the solve
  bool reads_inputs = false;  // input or input_rate
  bool jumps = false;         // what switches may jump: not an abs, min or max, which only bend
};

/// The surfaces below the roots, each once, in topological order; none for what moves with parameters alone:
///
///   abs(a), sign(a)                     a
///   min(a, b), max(a, b)                a - b
///   a < b, a <= b, a == b               a - b
///   floor(a)                            a, at integers
///   if a then ... with a number for a   a
///
/// A power with a fractional exponent is no surface: |z|^n has its kink in the abs. Differences become nodes of the graph.
std::vector<SwitchingSurface> switching_surfaces(Graph& graph, std::span<NodeId const> roots);

}  // namespace sysid
