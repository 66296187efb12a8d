// Draws that are higher than every mode which the search has found: it has missed one.
#pragma once
#include <vector>

#include "app/session/preparation.hpp"
#include "inference/backend/backend.hpp"
#include "likelihood/target.hpp"
#include "search/objective_kind.hpp"
#include "search/run_context.hpp"

namespace sysid {

/// Where the result says so (`FitResult::higher_place`), or at the draw of highest density, of a posterior, if that is more than
/// three nats above the highest of the modes: a rough density has places a little higher than where a search can end. Sampler's
/// coordinates; empty where there is none. Not asked of estimated densities, which scatter, nor of hierarchies, whose density grows
/// without end where their members agree.
std::vector<double> place_above_modes(FitResult const& result, Target const& target, ObjectiveKind objective_kind,
                                      std::vector<Mode> const& modes, bool hierarchical);

enum class HigherSearch { interrupted, nothing, found };
/// Local searches from there and from the modes of the preparation. Where one ends notably higher than all these, the modes found
/// take their place, with their findings; `nothing`, which changes none, where the density is rough.
HigherSearch search_from_place(std::vector<double> const& place, Target const& target, ObjectiveKind objective_kind,
                               Preparation& preparation, RunContext& context);

}  // namespace sysid
