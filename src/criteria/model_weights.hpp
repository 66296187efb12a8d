// Weights of models from their pointwise predictive scores: stacking and pseudo-BMA.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace sysid {

/// elpd[k][i]: log predictive density of sample i under model k. Finite, of at least two models and the same samples.
using PointwiseElpd = std::vector<std::vector<double>>;

/// The mixture of predictive distributions with the largest sum_i log sum_k w_k exp(elpd_ik): weights on the simplex.
///                                                                                    Yao, Vehtari, Simpson and Gelman 2018, eq. 4
/// By multiplicative updates, which climb the concave score, and steps ahead along them where these climb more; ended where no
/// weights can score more by 1e-7 per sample, or after 20,000 updates.
std::vector<double> stacking_weights(PointwiseElpd const& elpd);

/// Weights exp(elpd_k) / sum, averaged over 1000 Bayesian bootstraps of the samples.  Yao et al. 2018, sec. 3.4: pseudo-BMA+
std::vector<double> pseudo_bma_weights(PointwiseElpd const& elpd, std::uint64_t seed);

/// sum_i (a_i - b_i) and its standard error sqrt(n) sd(a_i - b_i), which an infinite sum has not (NaN). Two infinite ones do not
/// differ.
struct ElpdDifference {
  double sum = 0, error = 0;
};
ElpdDifference elpd_difference(std::span<double const> a, std::span<double const> b);

}  // namespace sysid
