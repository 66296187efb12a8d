// Parameters that the likelihood does not contain where the posterior lies, found by simulation.
#pragma once
#include "likelihood/parameter_space.hpp"
#include "likelihood/target.hpp"
#include "result/draws.hpp"
#include "result/finding.hpp"

namespace sysid {

/// `flat_direction`, a warning, of draws: parameters on which the log likelihood does not depend. At 24 draws, spread over all,
/// each takes a value from its prior, and no log likelihood changes by more than 1e-6. Nothing is looked at that is a coefficient,
/// or that priors of others read; nor an expensive or an estimated likelihood, nor one with an improper prior. space: of the
/// target, where it is none of these.
Findings check_influence(ParameterSpace const& space, Target const& target, Draws const& draws);

}  // namespace sysid
