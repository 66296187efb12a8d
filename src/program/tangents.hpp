// Derivatives of a simulation as further states, sums and records of a program: the variational equations, stepped by the same
// method in the same lanes.
#pragma once
#include <span>

#include "program/simulation_program.hpp"

namespace sysid {

/// Whether `with_squares` gives the derivative of what the program computes: a map or a method with fixed steps, explicit
/// equations, and functions whose derivatives are known.
bool has_tangents(SimulationSource const& source);

/// The source with its derivatives by K of its parameters, and with the normal equations of its residuals r, which are its records,
/// one per channel.
///
///   x' = f(x, p, t),  x(0) = g(p)        s_k' = df/dx s_k + df/dp_k,  s_k(0) = dg/dp_k
///
/// A method with fixed steps applied to both gives s_k the derivative of its own x, to rounding, and so it is for maps. Derivatives
/// that are zero whatever the values are take no state. Derivatives of expressions are `finite_slope`: at a kink of abs, min or max
/// that of one side or 0, of what jumps 0.
///
/// Behind the n sums of each channel come their derivatives by each parameter in turn, then, summed like them,
///   r dr/dp_k  (K),   dr/dp_k dr/dp_l  (K (K + 1)/2: l <= k, by k),
/// so that no residual leaves the lanes. No records.
SimulationSource with_squares(SimulationSource source, std::span<int const> parameters);

/// The source with the derivatives of its sums alone: behind the n sums of each channel come those by each parameter in turn.
SimulationSource with_gradient(SimulationSource source, std::span<int const> parameters);

/// Whether the states and the sums of `with_squares`, or of `with_gradient`, by K parameters are so few that it costs less than 2 K
/// + 1 values.
bool squares_are_cheap(SimulationSource const& source, int parameters);
bool gradient_is_cheap(SimulationSource const& source, int parameters);

}  // namespace sysid
