// The normal equations of the coefficients, with their priors.
#include "gaussian_process/linear_mean.hpp"

#include <cmath>
#include <numbers>

#include "core/numeric/elementary.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid::gaussian_process {
namespace {

/// A column this close to the span of those before it, relative to its length, says nothing of its own.
constexpr double dependence = 1e-12;

}  // namespace

Eigen::MatrixXd to_be_whitened(Observations const& observations) {
  Eigen::MatrixXd both(observations.values.size(), 1 + observations.columns.cols());
  both.col(0) = observations.values;
  if (observations.columns.cols() > 0) {
    both.rightCols(observations.columns.cols()) = observations.columns;
    both.col(0) -= observations.columns * observations.prior_mean;
  }
  return both;
}

LinearMean::LinearMean(Observations const& observations, Eigen::MatrixXd const& whitened, double log_determinant) {
  Eigen::Index const rows = whitened.rows(), count = whitened.cols() - 1;
  residual = whitened.col(0);
  double sum = -0.5 * (static_cast<double>(rows) * elementary::log(2 * std::numbers::pi) + log_determinant);
  if (count > 0) {
    Eigen::MatrixXd over = Eigen::MatrixXd::Zero(rows + count, count);
    over.topRows(rows) = whitened.rightCols(count);
    for (Eigen::Index j = 0; j < count; ++j)
      if (std::isfinite(observations.prior_sd[j])) {
        over(rows + j, j) = 1 / observations.prior_sd[j];
        sum -= elementary::log(observations.prior_sd[j]);
      } else {
        sum += 0.5 * elementary::log(2 * std::numbers::pi);
      }
    OrthogonalTriangular const factored(over);
    triangle = factored.triangle();
    for (Eigen::Index j = 0; j < count; ++j) {
      double const own = std::fabs(triangle(j, j));
      if (!(own > dependence * over.col(j).norm())) {
        outcome = std::isfinite(own) ? Outcome::dependent_columns : Outcome::not_finite;
        return;
      }
      sum -= elementary::log(own);
    }
    Eigen::VectorXd response = Eigen::VectorXd::Zero(rows + count);
    response.head(rows) = residual;
    Eigen::VectorXd const turned = factored.turned(response).topRows(count);
    shift = triangle.triangularView<Eigen::Upper>().solve(turned);
    basis = triangle.transpose().triangularView<Eigen::Lower>().solve(whitened.rightCols(count).transpose()).transpose();
    residual -= whitened.rightCols(count) * shift;
    sum -= 0.5 * (over.bottomRows(count) * shift).squaredNorm();
  }
  log_likelihood = sum - 0.5 * residual.squaredNorm();
  if (!std::isfinite(log_likelihood)) {
    log_likelihood = -std::numeric_limits<double>::infinity();
    outcome = Outcome::not_finite;
  }
}

Coefficients LinearMean::coefficients(Observations const& observations) const {
  if (shift.size() == 0) return {};
  Eigen::MatrixXd const inverse = solve_upper(triangle, Eigen::MatrixXd::Identity(triangle.rows(), triangle.cols()));
  return {observations.prior_mean + shift, inverse * inverse.transpose()};
}

Eigen::MatrixXd LinearMean::scaled(Eigen::MatrixXd const& rows) const {
  return triangle.transpose().triangularView<Eigen::Lower>().solve(rows.transpose());
}

}  // namespace sysid::gaussian_process
