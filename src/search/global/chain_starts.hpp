// Where chains begin: around the modes that a search has found, or at draws of the prior.
#pragma once
#include <optional>
#include <vector>

#include "likelihood/target.hpp"
#include "result/mode.hpp"
#include "search/run_context.hpp"

namespace sysid {

/// Spreads `chains` over modes by their shares: every mode above 1 % gets one while chains last, the rest go where the share is
/// most under-represented. Returns the mode of each chain; modes in order.
std::vector<int> spread_over_modes(std::vector<Mode> const& modes, int chains);

/// Starts [P x chains] around each chain's mode: normal with three times its Laplace sd, redrawn (up to 100 times) while the
/// density is not finite, the mode itself after that.
LaneArray overdispersed_starts(Target const& target, std::vector<Mode> const& modes, std::vector<int> const& mode_of_chain,
                               RunContext& context);

/// Starts [P x chains] from the prior, each redrawn until its density is finite. Chains without one after 1000 attempts begin where
/// another does; nothing where none has found one.
std::optional<LaneArray> prior_starts(Target const& target, int chains, RunContext& context);

}  // namespace sysid
