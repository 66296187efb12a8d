// Residuals of unit size under any noise: what chi-squared is taken of.
#pragma once
#include <vector>

#include "distribution/distribution.hpp"

namespace sysid {

/// Residuals of unit size, and how much heavier than normal their tails are.
struct SizedResiduals {
  std::vector<double> values;
  double excess_kurtosis = 0;
  std::vector<double> degrees = {};  // of counts instead, by which each sample weighs: see `chi_squared_of_counts`
};

/// Pearson's, of counts: the deviance residuals of small counts are not of unit size. NaN where none is expected at all.
/// arguments: of the channel's noise, at every sample; deviance: one residual per sample, NaN where not scored.
SizedResiduals pearson_residuals(DistributionRow const& noise, std::vector<double> const& measured,
                                 std::vector<std::vector<double>> const& arguments, std::vector<double> const& deviance);

/// Deviance residuals over their size under the noise, which for heavy tails is above 1. It depends on the shape of the noise
/// alone, not on place and width, and a shape that changes along the record is met at a few of its samples.
SizedResiduals scaled_residuals(DistributionRow const& noise, std::vector<std::vector<double>> const& arguments,
                                std::vector<double> deviance);

}  // namespace sysid
