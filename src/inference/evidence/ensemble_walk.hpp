// Draws of nearly the right distribution walk further into its tails, where the proposals that they came from have not reached.
#pragma once
#include <functional>

#include "core/numeric/random.hpp"
#include "core/system/ledger.hpp"
#include "search/objective.hpp"

namespace sysid::marginal {

/// Steps in which walkers forget where they were, a few times over.
inline int long_walk(int dimension) { return 60 + 10 * dimension; }
/// Power of the density along which walkers spread first: what is too wide shrinks sooner than what is too narrow grows.
inline constexpr double spreading_power = 0.2;

/// Moves `walkers` [P x W], W >= 8, by Metropolis steps x' = x + g (a - b), a and b two walkers of the other half, g of the optimum
/// for a normal density and 1 once in ten moves. Each half moves in one batch. A walker at a place without a finite density takes
/// the first step that has one.                                                           ter Braak 2006 (differential evolution)
///
/// power: of the density, which below 1 spreads the walkers further than it does itself.
/// Returns the states after two, three and four quarters of the `steps` side by side: [P x 3 W].
LaneArray walk(Objective const& objective, LaneArray walkers, int steps, StreamKey key, Ledger& ledger,
               std::function<bool()> const& stop, double power = 1);

}  // namespace sysid::marginal
