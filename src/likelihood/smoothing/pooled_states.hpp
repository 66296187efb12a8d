// Smoothed states over draws of the parameters.
#pragma once
#include <vector>

#include "likelihood/smoothing/smoother.hpp"
#include "result/prediction.hpp"

namespace sysid {

/// One of each quantity: of the mixture with equal weights of the normal distributions that the draws give at a sample, its mean,
/// its sd by the law of total variance, and its quantiles of 2.5 and 97.5 %. Vectors that failed are left out, NaN where all did.
/// parameters: of the model, SI [parameters x draws]; of long records the first draws of a spread of them are enough to fill
/// memory, the number depends on the length alone.
std::vector<Band> pooled_states(Smoother const& smoother, ConstLanes parameters);

/// The mixture with equal weights of normal distributions: mean, sd by the law of total variance, quantiles of 2.5 and 97.5 %.
struct NormalMixture {
  double mean, sd, lower, upper;
};
/// Not empty.
NormalMixture normal_mixture(std::vector<double> const& means, std::vector<double> const& sds);

/// The x where sum_d P(mean_d + sd_d Z <= x)/D is the probability; at sd = 0 the distribution is a step. Not empty.
double normal_mixture_quantile(std::vector<double> const& means, std::vector<double> const& sds, double probability);

}  // namespace sysid
