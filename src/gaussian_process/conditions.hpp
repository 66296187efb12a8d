// What conditions take off a covariance at given hyper-parameters.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "gaussian_process/covariance.hpp"

namespace sysid::gaussian_process {

/// a(x)^T B^-1 a(x') of Covariance::conditioned, with B = L L^T over the conditions that the others do not imply.
class Conditions {
 public:
  Conditions(Covariance const& free, std::vector<Condition> const& conditions, Numbers parameters);

  /// L^-1 a(x_i) in column i [conditions x N], x the rows of inputs.
  Eigen::MatrixXd whitened(Eigen::MatrixXd const& inputs) const;

  /// Sum over all i and j of weight_ij d(a_i^T B^-1 a_j)/dlog(parameter), of a symmetric weight whose lower triangle is read. With
  /// Q = A B^-1, rows of A the a_i,
  ///
  ///   d(A B^-1 A^T) = dA Q^T + Q dA^T - Q dB Q^T
  ///
  /// so the sum is 2 <W Q, dA> - <Q^T W Q, dB>.
  Eigen::VectorXd gradient(Eigen::MatrixXd const& inputs, Eigen::MatrixXd const& lower_weight) const;

 private:
  Condition at(Eigen::MatrixXd const& inputs, Eigen::Index row) const;

  Covariance const& free_;
  Numbers parameters_;
  std::vector<Condition> kept_;
  Eigen::MatrixXd lower_;  // L
};

}  // namespace sysid::gaussian_process
