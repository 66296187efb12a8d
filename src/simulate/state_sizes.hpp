// How large the states of a solve are, before it has shown it: what error control measures the error of a state near zero by.
#pragma once
#include <span>

#include "simulate/lane_equations.hpp"

namespace sysid {

/// Raises `sizes` [states], the largest magnitudes reached so far, to what the equations say about `states` at `time`, in the
/// interval that they are set to, which ends at `end`. With J their Jacobian and f the largest rates of three places, here and now,
/// at the end of the interval, and an Euler step of tau ahead,
///
///   tau = min(end - time, 1/max_ij sqrt|J_ij J_ji|)
///   size_i >= |y_i|,  tau |f_i|,  and where all that is 0:  tau sum_j |J_ij| size_j
///   size_i >= 1000 (4 epsilon/relative) tau sum_j |J_ij y_j|
///
/// so that no answer depends on the units of the states. The last line is the rounding error of the rates: a state that stays at
/// zero because its forces cancel is not asked for digits of that rounding. Algebraic states take from their constraints, solved
/// for them one by one, what differential ones take from tau f. A size stays 0 where nothing moves at either end.
void raise_sizes(LaneEquations& equations, double time, double end, std::span<double const> states, SolverSettings const& solver,
                 std::span<double> sizes);

}  // namespace sysid
