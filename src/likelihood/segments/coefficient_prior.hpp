// How probable coefficients are before the record: most have terms that act about as strongly as the motion is large.
#pragma once
#include <Eigen/Core>

namespace sysid {

/// Length of the motion in units of the noise: sqrt(1 + N r), N samples, r the variance of the motion over that of the noise.
double signal_of(double samples, double variance_ratio);

/// log of the integral of exp(-|R (c - estimate)|^2 / 2) prod_j p(c_j) over the coefficients c by Laplace's method, where ln |c_j|
/// has Laplace's distribution of scale 3/2 about ln M_j, M_j = signal / |R_j| the coefficient whose term alone acts as strongly as
/// the motion is large:
///
///   p(c) = exp(-2/3 |ln |c/M||) / (6 |c|)
///
///   - sum_j [log(6 |c_j|) + 2/3 |log |c_j / M_j||] + k/2 log(2 pi) - log |det R|,    |c_j| at least its sd
///
/// estimate [k]; upper: R [k x k], triangular, so that R^T R is the information on the coefficients, R_j its columns. Units of
/// coefficients cancel.
///
/// The last `others` of them are no coefficients: the integral is over a density of 1 in their places.
double log_coefficient_weight(Eigen::VectorXd const& estimate, Eigen::MatrixXd const& upper, double signal, int others = 0);

}  // namespace sysid
