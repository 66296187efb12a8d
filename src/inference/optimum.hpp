// `map` and `ml`: one point and its Laplace widths, in the form of every other result.
#pragma once
#include "inference/backend/backend.hpp"

namespace sysid::optimum {

/// The maximum of the density of the *declared* parameters (no Jacobian): the answer does not depend on the sampler's coordinates.
/// The result is one chain of one draw, the optimum; modes.front() holds its sds and covariance.
FitResult run_map(Target const& target, Settings const& settings, RunContext& context);

/// The maximum of the likelihood alone; the prior only says where to search and where a bounded parameter must stay.
FitResult run_ml(Target const& target, Settings const& settings, RunContext& context);

}  // namespace sysid::optimum
