// Automatic relevance determination: sparse Bayesian learning.
#pragma once
#include <span>

#include "regression/choice/selector.hpp"

namespace sysid::regression::ard {

std::span<SettingRow const> settings();

/// Maximises the evidence of Gaussian priors N(0, 1/lambda_j) on scaled coefficients and noise precision alpha by MacKay's
/// fixed-point updates (MacKay 1992; Tipping 2001, eqs. 16-17), dropping terms whose lambda passes `prune`:
///
///   Sigma = (diag(lambda) + alpha A^T A)^-1,  mu = alpha Sigma A^T b,  gamma_j = 1 - lambda_j Sigma_jj
///   lambda_j <- (gamma_j + 2e-6) / (mu_j^2 + 2e-6),  alpha <- (K - sum gamma + 2e-6) / (|b - A mu|^2 + 2e-6)
///
/// Columns and known side are scaled to unit root mean square; 1e-6 are the shape and rate of the precisions' gamma priors. Terms
/// with `always` keep lambda at 1e-12.
Choice choose(LinearProblem const& problem, Settings const& settings, SelectorContext const& context);

}  // namespace sysid::regression::ard
