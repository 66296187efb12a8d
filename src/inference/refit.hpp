// Known modes followed to a neighbouring target: a finer step, a shifted input, another rule between samples.
#pragma once
#include <vector>

#include "inference/backend.hpp"

namespace sysid {

/// Local searches on the posterior of `target` from each of `modes`, which are those of a target with the same parameters. Modes
/// come back in the order given (shares as they were); one whose density is not finite any more keeps its place with log_density
/// -infinity.
std::vector<Mode> refit(Target const& target, std::vector<Mode> const& modes, std::uint64_t seed, Ledger& ledger);

/// The largest move of a parameter between two places, in units of `before`'s sds; infinite when `after` is not finite.
double largest_move(Mode const& before, Mode const& after);

}  // namespace sysid
