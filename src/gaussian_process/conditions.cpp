// Cholesky's factor over the conditions that the earlier ones do not imply, and covariances of rows with it.
#include "gaussian_process/conditions.hpp"

#include <cmath>

namespace sysid::gaussian_process {
namespace {

/// Of its own variance: what the conditions before leave of one that says nothing new. Its square root is what such a condition may
/// be off by, in sds of the prior; the rounding error of those that are kept grows to 1e-16 over it.
constexpr double implied = 1e-10;

}  // namespace

Conditions::Conditions(Covariance const& free, std::vector<Condition> const& conditions, Numbers parameters)
    : free_(free), parameters_(parameters) {
  auto const count = static_cast<Eigen::Index>(conditions.size());
  Eigen::MatrixXd covariance(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j <= i; ++j)
      covariance(i, j) = covariance(j, i) =
          free.between(conditions[static_cast<std::size_t>(i)], conditions[static_cast<std::size_t>(j)], parameters);
  // Cholesky's factor row by row, of one condition after the other that those before leave open.
  lower_ = Eigen::MatrixXd::Zero(count, count);
  std::vector<Eigen::Index> places;
  for (Eigen::Index i = 0; i < count; ++i) {
    auto const kept = static_cast<Eigen::Index>(places.size());
    double left = covariance(i, i);
    for (Eigen::Index j = 0; j < kept; ++j) {
      double sum = covariance(i, places[static_cast<std::size_t>(j)]);
      for (Eigen::Index k = 0; k < j; ++k) sum -= lower_(kept, k) * lower_(j, k);
      lower_(kept, j) = sum / lower_(j, j);
      left -= lower_(kept, j) * lower_(kept, j);
    }
    if (!(left > implied * covariance(i, i))) continue;
    lower_(kept, kept) = std::sqrt(left);
    places.push_back(i);
    kept_.push_back(conditions[static_cast<std::size_t>(i)]);
  }
  lower_.conservativeResize(static_cast<Eigen::Index>(kept_.size()), static_cast<Eigen::Index>(kept_.size()));
}

Condition Conditions::at(Eigen::MatrixXd const& inputs, Eigen::Index row) const {
  Condition result;
  for (Eigen::Index c = 0; c < inputs.cols(); ++c) result.point.push_back(inputs(row, c));
  return result;
}

Eigen::MatrixXd Conditions::whitened(Eigen::MatrixXd const& inputs) const {
  Eigen::MatrixXd result(static_cast<Eigen::Index>(kept_.size()), inputs.rows());
  for (Eigen::Index i = 0; i < inputs.rows(); ++i) {
    Condition const here = at(inputs, i);
    for (std::size_t c = 0; c < kept_.size(); ++c)
      result(static_cast<Eigen::Index>(c), i) = free_.between(here, kept_[c], parameters_);
  }
  lower_.triangularView<Eigen::Lower>().solveInPlace(result);
  return result;
}

Eigen::VectorXd Conditions::gradient(Eigen::MatrixXd const& inputs, Eigen::MatrixXd const& lower_weight) const {
  auto const count = static_cast<Eigen::Index>(kept_.size());
  Eigen::MatrixXd weights = whitened(inputs);  // Q^T
  lower_.transpose().triangularView<Eigen::Upper>().solveInPlace(weights);
  Eigen::MatrixXd const of_cross = lower_weight.selfadjointView<Eigen::Lower>() * weights.transpose();
  Eigen::MatrixXd const of_conditions = weights * of_cross;
  Eigen::VectorXd result = Eigen::VectorXd::Zero(free_.parameter_count());
  for (int p = 0; p < free_.parameter_count(); ++p) {
    for (Eigen::Index i = 0; i < inputs.rows(); ++i) {
      Condition const here = at(inputs, i);
      for (Eigen::Index c = 0; c < count; ++c)
        result[p] += 2 * of_cross(i, c) * free_.between(here, kept_[static_cast<std::size_t>(c)], parameters_, p);
    }
    for (Eigen::Index b = 0; b < count; ++b)
      for (Eigen::Index c = 0; c < count; ++c)
        result[p] -= of_conditions(b, c) *
                     free_.between(kept_[static_cast<std::size_t>(b)], kept_[static_cast<std::size_t>(c)], parameters_, p);
  }
  return result;
}

}  // namespace sysid::gaussian_process
