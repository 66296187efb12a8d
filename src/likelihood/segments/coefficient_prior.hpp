// How probable coefficients are before the record: alike on every scale on which their terms can act on it.
#pragma once
#include <Eigen/Core>

namespace sysid {

/// ln of the motion over the noise that N samples leave: 1/2 log(1 + N r), r the variance of the motion over that of the noise. On
/// so many scales, in units of e, a term can matter; at least 1.
double scales_shown(double samples, double variance_ratio);

/// log of the integral of exp(-|R (c - estimate)|^2 / 2) prod_j 1/(2 scales |c_j|) over the coefficients c by Laplace's method:
///
///   - sum_j log(2 scales max(|c_j|, sd_j)) + k/2 log(2 pi) - log |det R|
///
/// estimate [k]; upper: R [k x k], triangular, so that R^T R is the information on the coefficients. Units of coefficients cancel.
double log_coefficient_weight(Eigen::VectorXd const& estimate, Eigen::MatrixXd const& upper, double scales);

}  // namespace sysid
