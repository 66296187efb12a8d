// A stationary Gaussian process on a box as a finite sum of known functions with independent normal coefficients: what an equation
// in continuous time can hold.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "gaussian_process/covariance.hpp"

namespace sysid::gaussian_process {

/// Eigenfunctions of the Laplace operator on the box of centre c and half-widths L, zero at its faces; for j_d = 1 ... count_d, the
/// last input's fastest:
///
///   phi_j(x) = product over d of L_d^(-1/2) sin(w_jd (x_d - c_d + L_d)),   w_jd = pi j_d/(2 L_d)
///
///   k(x, x') = sum over j of S(w_j) phi_j(x) phi_j(x'), nearly                   Solin & Särkkä 2020, eq. 56, 60, 68
///
/// Good where x keeps some length-scales away from the faces and the highest frequencies lie beyond the kernel's.
class Basis {
 public:
  /// Each [D]; half_widths > 0, counts >= 1.
  Basis(Eigen::VectorXd centre, Eigen::VectorXd half_widths, std::vector<int> const& counts);

  int size() const { return static_cast<int>(frequencies_.rows()); }
  /// w_jd, angular frequencies [size x D].
  Eigen::MatrixXd const& frequencies() const { return frequencies_; }
  /// phi_j at the rows of inputs [N x D]: [N x size].
  Eigen::MatrixXd functions(Eigen::MatrixXd const& inputs) const;

 private:
  Eigen::VectorXd centre_, half_widths_;
  Eigen::MatrixXd frequencies_;
};

/// Whether the covariance is a sum of kernels that have a spectral density and all read the same inputs.
bool has_spectral_density(Covariance const& covariance);

/// S(w_j), the variances of the coefficients [size]; the basis is over the inputs in the order in which the kernels read them.
Eigen::VectorXd spectral_weights(Covariance const& covariance, Numbers parameters, Basis const& basis);

}  // namespace sysid::gaussian_process
