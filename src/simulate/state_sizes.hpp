// The size of the states before a solve, from which error control takes its scale for a state near zero.
#pragma once
#include <span>

#include "simulate/lane_equations.hpp"

namespace sysid {

/// Raises `sizes` [states], the largest magnitudes reached so far, to |states| and to where a trial step of length h leads from
/// there: `time` to `end`, the interval that the equations are set to, or a part of it, ten times shorter until a step and two
/// halves agree in every state to a tenth. It is a size that the solution really reaches, so the error allowed is never too large;
/// and no answer depends on the units of the states.
///
///   size_i >= 1000 (4 epsilon/relative) h sum_j |J_ij y_j|,  J: the Jacobian
///
/// is the rounding error of the rates: a state that stays at zero because its forces cancel is not asked for digits of it.
/// Algebraic states at zero are as large as their own constraint makes them. A size stays 0 where nothing moves.
void raise_sizes(LaneEquations& equations, double time, double end, std::span<double const> states, SolverSettings const& solver,
                 std::span<double> sizes);

}  // namespace sysid
