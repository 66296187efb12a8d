// The closed form by the inverse of the covariance.
#include "gaussian_process/leave_one_out.hpp"

#include "linear_algebra/lapack.hpp"

namespace sysid::gaussian_process {

Prediction leave_one_out(Covariance const& covariance, Observations const& observations, Numbers parameters) {
  Eigen::Index const count = observations.values.size();
  Eigen::MatrixXd matrix(count, count);
  covariance.fill_lower(observations.inputs, parameters.first(parameters.size() - 1), matrix);
  matrix.diagonal().array() += parameters.back() * parameters.back();
  if (!lapack::cholesky(matrix)) return {};
  Eigen::MatrixXd weights = observations.values;
  lapack::solve_lower(matrix, weights);
  lapack::solve_lower_transposed(matrix, weights);
  lapack::invert_cholesky(matrix);
  Eigen::VectorXd const precision = matrix.diagonal();
  return {observations.values - weights.col(0).cwiseQuotient(precision), precision.cwiseInverse()};
}

}  // namespace sysid::gaussian_process
