// Each observation predicted from all the others, without fitting again.
#pragma once
#include "gaussian_process/covariance.hpp"
#include "gaussian_process/observations.hpp"

namespace sysid::gaussian_process {

/// With K the covariance of the observations, noise included, coefficients of the mean held (columns are not read):
///
///   mean_i = y_i - (K^-1 y)_i/(K^-1)_ii,   variance_i = 1/(K^-1)_ii                     Rasmussen & Williams 2006, eq. 5.12
///
/// variances are those of an observation; parameters, and the jitter that K may need, as for `dense_marginal`. Empty where K is not
/// positive definite even so.
Prediction leave_one_out(Covariance const& covariance, Observations const& observations, Numbers parameters);

}  // namespace sysid::gaussian_process
