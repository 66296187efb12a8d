// Standard deviations of derived quantities at an optimum: the delta method.
#pragma once
#include <cstdint>
#include <span>

#include "app/fit/fit_likelihood.hpp"

namespace sysid {

/// Sets the sds of the derived quantities of an optimum, or why there is none; does nothing where there are draws. To first order
///
///   sd(d)^2 = g' C g,   g = the gradient of d at the mode, C = the Laplace covariance                  Oehlert 1992, sec. 2
///
/// over the sampler's coordinates. g is by central differences along the axes of C, 1e-3 sds long: d alone is computed there, in
/// closed form, with no simulation. There is no sd where C is not the posterior's as far as d reads it (the search has not
/// converged, a parameter lies at a bound or has a posterior that is not normal, the data leave d open), where d has no derivative
/// at the mode, and where what the first order leaves out is more than half of it: over 512 points of the normal distribution with
/// the covariance C, drawn with `seed`, the root mean square of d(x) - d(mode) - g'(x - mode).
/// draws: the optimum with its derived quantities, as `summaries` has them.
void add_derived_sds(FitLikelihood const& likelihood, Target const& target, FitResult const& result, Draws const& draws,
                     std::uint64_t seed, std::span<Summary> summaries);

}  // namespace sysid
