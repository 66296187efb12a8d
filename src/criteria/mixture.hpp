// Mixtures of predictive distributions, each known by draws of its own: quantiles, and where the variance comes from.
#pragma once
#include <span>
#include <vector>

namespace sysid {

/// Draws of one member of a mixture.
struct MixtureDraws {
  double weight = 0;               // above 0
  std::span<double const> values;  // rising, not empty
};

/// The x where sum_k w_k F_k(x) is the probability. F_k rises in straight lines between the draws, i / (n + 1) at the i-th of n,
/// and jumps there at the first and the last. Of one member this is `predictive_quantile`; each member may have any number of
/// draws, whatever its weight.
double mixture_quantile(std::span<MixtureDraws const> members, double probability);

/// Of one sample. Weights sum to 1.
///
///   Var y = sum_k w_k Var(E[y | theta, k] | k) + sum_k w_k (E[y | k] - E y)^2 + sum_k w_k E[Var(y | theta, k) | k]
///
/// the law of total variance: parameter, model and noise.
struct VarianceSplit {
  double mean = 0, parameter = 0, model = 0, noise = 0;
  double total() const { return parameter + model + noise; }
};
struct MemberMoments {
  double weight = 0, mean = 0, variance = 0, noise = 0;  // mean and variance over draws of the mean given each; mean noise variance
};
VarianceSplit split_variance(std::span<MemberMoments const> members);

/// Of values that are draws of several models, those of each together: weights are shares of the draws, and the parts sum to the
/// sample variance (divisor n - 1) of all. groups: not empty, two values at least.
VarianceSplit split_pooled(std::span<std::vector<double> const> groups);

/// log sum_k w_k p_k of log p_k; members of weight 0 count for nothing, whatever their density.
double log_mixture_density(std::span<double const> weights, std::span<double const> log_density);

}  // namespace sysid
