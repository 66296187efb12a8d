// `search = near(posterior)`: the modes of a fit from where an earlier one ended, its model changed or not.
#pragma once
#include "app/session/session.hpp"
#include "search/global/search.hpp"

namespace sysid {

/// Places [P x W] on the unbounded scales of `target`, the first at the best of the `earlier` draws: parameters of the same name
/// and unit have their values there, coefficients of a function that is new are zero, others, and those whose prior no longer
/// allows the earlier value, are draws of their priors.
LaneArray starts_near(Target const& target, Draws const& earlier, std::uint64_t seed);

/// Local searches from there, of the fit task `earlier`. UserError where that fit has left no draws.
SearchResult search_near(Session& session, int earlier, Target const& target, ObjectiveKind objective_kind, RunContext& context);

}  // namespace sysid
