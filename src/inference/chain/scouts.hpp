// Walkers that look where chains have not been.
#pragma once
#include <cstdint>

#include "core/numeric/lanes.hpp"
#include "core/system/ledger.hpp"
#include "search/objective.hpp"

namespace sysid::metropolis {

inline constexpr int scouts = 64;

/// from [P x W]: states of chains, at most `scouts` of them. They walk by differential evolution
/// (inference/evidence/ensemble_walk.hpp), first over the fifth root of the density, whose tails are wide, then back over the
/// density. Returns where they have been halfway back, after three quarters, and at the end [P x 3 W]: spread like the density, or
/// wider.
///
/// round: which time it is; each has its own random numbers.
LaneArray scout(Objective const& objective, LaneArray from, std::uint64_t seed, std::uint64_t round, Ledger& ledger);

/// Simulations that it takes.
std::uint64_t cost_of_scouts(int dimension);

}  // namespace sysid::metropolis
