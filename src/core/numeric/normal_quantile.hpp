// Quantiles of the standard normal, from elementary functions alone: the same bits on every processor.
#pragma once

namespace sysid {

/// The z with P(Z <= z) = probability, 0 < probability < 1; relative error about 1e-16.
double standard_normal_quantile(double probability);
/// The z with P(0 <= Z <= z) = q, |q| < 1/2, exact near 0.
double standard_normal_quantile_from_middle(double q);
/// `standard_normal_quantile` but for the last bits where 0.075 <= probability <= 0.925: the ratio of the polynomials is rounded
/// before it is multiplied, and a coefficient has one digit more. The convergence diagnostics take their normal scores from it, and
/// stored summaries hold these bits.
double normal_score(double probability);

}  // namespace sysid
