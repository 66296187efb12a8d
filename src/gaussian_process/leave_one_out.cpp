// The closed form by the inverse of the covariance.
#include "gaussian_process/leave_one_out.hpp"

#include "gaussian_process/dense.hpp"
#include "linear_algebra/lapack.hpp"

namespace sysid::gaussian_process {

Prediction leave_one_out(Covariance const& covariance, Observations const& observations, Numbers parameters) {
  PriorFactor factored = observed_factor(covariance, observations.inputs, parameters);
  if (!factored.fine) return {};
  Eigen::MatrixXd& matrix = factored.lower;
  Eigen::MatrixXd weights = observations.values;
  lapack::solve_lower(matrix, weights);
  lapack::solve_lower_transposed(matrix, weights);
  lapack::invert_cholesky(matrix);
  Eigen::VectorXd const precision = matrix.diagonal();
  return {observations.values - weights.col(0).cwiseQuotient(precision), precision.cwiseInverse()};
}

}  // namespace sysid::gaussian_process
