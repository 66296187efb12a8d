// `search = near(posterior)`: the modes of a fit from where an earlier one ended, its model changed or not.
#pragma once
#include "app/session/session.hpp"
#include "search/search.hpp"

namespace sysid {

/// Local searches from draws of the fit task `earlier`: parameters of the same name and unit begin at their values there,
/// coefficients of a function that is new at zero, others at draws of their priors. UserError where that fit has left no draws.
SearchResult search_near(Session& session, int earlier, Target const& target, ObjectiveKind objective_kind, RunContext& context);

}  // namespace sysid
