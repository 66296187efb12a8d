// Draws of nearly the right distribution walk further into its tails, where the proposals that they came from have not reached.
#pragma once
#include <functional>
#include <vector>

#include "core/numeric/random.hpp"
#include "core/system/ledger.hpp"
#include "search/objective.hpp"

namespace sysid::marginal {

/// Moves `walkers` [P x W], W >= 8, by Metropolis steps x' = x + g (a - b), a and b two walkers of the other half, g of the optimum
/// for a normal density and 1 once in ten moves. Each half moves in one batch. log_density [W]: at the walkers; a walker without a
/// finite one takes the first step that has one.                                          ter Braak 2006 (differential evolution)
///
/// Returns the states after each quarter of the `steps` but the first, side by side: [P x 3 W].
LaneArray walk(Objective const& objective, LaneArray walkers, std::vector<double> log_density, int steps, StreamKey key,
               Ledger& ledger, std::function<bool()> const& stop);

}  // namespace sysid::marginal
