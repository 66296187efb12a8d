// Places far from the mode that fit as well as it does.
#pragma once
#include <cstdint>
#include <functional>

#include "result/finding.hpp"
#include "result/mode.hpp"
#include "search/objective.hpp"

namespace sysid::unbounded {

/// A phase without bounds fits at every period, and no such posterior has an integral; a tail that is followed from the mode only
/// sees the fall next to it. So for each coordinate with an improper prior, local searches in all coordinates begin at irregular
/// distances of 10 to 10^5 sds from the mode, eight on either side; on a logarithm, on the upper one. Two different places that fit
/// as well as the mode are a warning, since a symmetry of the model may have a few. Four, the furthest twenty times as far as the
/// nearest, are an error.
Findings find_repeats(Objective const& objective, Mode const& mode, std::uint64_t seed, std::function<bool()> const& stop);

}  // namespace sysid::unbounded
