// The mean's coefficients, integrated out of a record in which the Gaussian process and the noise have been whitened.
#pragma once
#include <limits>

#include "gaussian_process/observations.hpp"

namespace sysid::gaussian_process {

/// [y - H b, H], b the prior means: what a route whitens. [N x 1 + p]
Eigen::MatrixXd to_be_whitened(Observations const& observations);

/// With K = L L^T the covariance of g + noise, z = L^-1 (y - H b), V = L^-1 H, S the prior sds of beta = b + d:
///
///   R^T R = V^T V + S^-2,   d = (R^T R)^-1 V^T z,   e = z - V d,
///   log p(y) = -1/2 (N - flat) log 2 pi - 1/2 log |K| - log |R| - log |S proper| - 1/2 (|e|^2 + |S^-1 d|^2)
///
///                                                                                    Rasmussen & Williams 2006, eq. 2.41 to 2.45
/// R from a QR decomposition of V over S^-1, so that badly scaled columns lose no digits.
struct LinearMean {
  Outcome outcome = Outcome::fine;
  double log_likelihood = -std::numeric_limits<double>::infinity();
  Eigen::VectorXd shift;     // d [p]
  Eigen::MatrixXd triangle;  // R [p x p]
  Eigen::MatrixXd basis;     // V R^-1 [N x p]
  Eigen::VectorXd residual;  // e [N]

  LinearMean() = default;
  /// whitened: L^-1 of `to_be_whitened`; log_determinant: log |K|.
  LinearMean(Observations const& observations, Eigen::MatrixXd const& whitened, double log_determinant);

  Coefficients coefficients(Observations const& observations) const;
  /// R^-T rows^T [p x M], rows [M x p]: its columns' squared lengths are the variances that the coefficients bring.
  Eigen::MatrixXd scaled(Eigen::MatrixXd const& rows) const;
};

}  // namespace sysid::gaussian_process
