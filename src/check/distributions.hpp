// A distribution call in a prior or after `observe`: arguments by position or name, one spelling each, truncation.
#pragma once
#include <optional>

#include "check/scope.hpp"
#include "distribution/distribution.hpp"

namespace sysid {

/// unit: of the variate; literals among the arguments take it, to the power their role asks. Nothing when a diagnostic was added.
std::optional<Distribution> check_distribution(Scope& scope, ast::Call const& call, std::optional<Unit> const& unit);

/// The argument that decides the unit of an observed channel: the first one (mean, median, location), if the call has any.
ast::Expression const* location_argument(ast::Call const& call);

}  // namespace sysid
