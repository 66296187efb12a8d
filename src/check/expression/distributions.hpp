// A distribution call in a prior or after `observe`: arguments by position or name, one spelling each, truncation.
#pragma once
#include <optional>

#include "check/expression/scope.hpp"
#include "distribution/distribution.hpp"
#include "model/model.hpp"

namespace sysid {

/// variate: what is distributed. Its unit, to the power that the role of each argument asks, is that of the arguments: literals
/// take it, others must have it. Nothing when a diagnostic was added that leaves no distribution.
std::optional<Distribution> check_distribution(Scope& scope, ast::Call const& call, Quantity const& variate);

/// The argument that decides the unit of an observed channel: the first one (mean, median, location), if the call has any.
ast::Expression const* location_argument(ast::Call const& call);

}  // namespace sysid
