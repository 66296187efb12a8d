// The generalised Pareto distribution of what exceeds a threshold, fitted to the largest importance weights: its shape k says how
// heavy their tail is, and its quantiles replace them. As the package `loo` of R has it, to the rounding.
#pragma once
#include <span>
#include <vector>

namespace sysid {

/// P(X > x) = (1 + k x / sigma)^(-1/k), x >= 0; an exponential distribution where k is 0. Moments of order 1/k and above are
/// infinite.
struct GeneralisedPareto {
  double k = 0, sigma = 0;

  /// The x with P(X <= x) = probability, 0 <= probability < 1.
  double quantile(double probability) const;
};

/// The fit of Zhang and Stephens (Technometrics 2009), an average of the profile likelihood over a grid, with k drawn towards 1/2
/// as ten further exceedances would                                                   Vehtari, Simpson, Gelman, Yao and Gabry 2024,
/// app. G
///
/// rising: exceedances >= 0, sorted, at least 5. k is infinite where there is no fit: a quarter of them are 0, or all of them.
GeneralisedPareto fit_generalised_pareto(std::span<double const> rising);

/// Importance weights whose tail is replaced by expected order statistics of its fit.
struct SmoothedWeights {
  std::vector<double> log_weights;  // not normalised
  /// Shape of the tail; infinite where there is none (fewer than 5 in it), -infinity where those in it do not differ, which is
  /// harmless: weights are as they were. Below 1/2 their variance is finite, and above 0.7 averages by the weights are not to be
  /// trusted.
  double k = 0;
};

/// How many of `draws` weights make a tail: min(0.2 S, 3 sqrt(S / r)), where r is the effective number of draws over S.
int pareto_tail_length(int draws, double relative_efficiency);

/// Pareto smoothed importance sampling. No smoothed weight exceeds the largest of before.
///
/// log_ratios: finite, or -infinity, of any common size.                           Vehtari, Simpson, Gelman, Yao and Gabry 2024,
/// alg. 1
SmoothedWeights smooth_weights(std::span<double const> log_ratios, int tail_length);

}  // namespace sysid
