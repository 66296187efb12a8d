// Does a filter that describes random states by mean and covariance have the right likelihood? Particles, which assume nothing of
// the distribution of the states, estimate it at a few draws.
#pragma once
#include <string>

#include "app/fit/fit_checks.hpp"

namespace sysid {

/// Why particles are not tried, one sentence; empty: they are.
std::string without_particle_comparison(FinishedFit const& fit);

/// What particles say of the filter of the fit. Where they cannot decide, the last record of the report's checks, which is that of
/// this one, gets the reason. What a comparison with another filter has found before is completed, or taken back where particles
/// say that the filter of the fit is the better one.
Findings compare_with_particles(FinishedFit& fit);

}  // namespace sysid
