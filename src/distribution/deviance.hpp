// The size of deviance residuals under the noise itself, which chi-squared compares with those of a fit.
#pragma once
#include <span>

#include "distribution/distribution.hpp"

namespace sysid {

/// Mean and variance of D = 2 (s - log p(Y)), Y of the noise, s the largest log density that a location gives Y: the squared
/// deviance residual. 1 and 2 for normal and log-normal noise; of heavier tails more, (n + 1) (psi((n + 1)/2) - psi(n/2)) for
/// Student's t.
struct DevianceMoments {
  double mean = 1, variance = 2;
  /// That of D over its mean, in the place of chi-squared's: its variance less 2.
  double excess_kurtosis() const { return variance / (mean * mean) - 2; }
};

/// arguments: numbers in canonical form, admissible; the noise untruncated, not discrete. To 1e-5 of the mean.
DevianceMoments deviance_moments(DistributionRow const& noise, std::span<double const> arguments);

}  // namespace sysid
