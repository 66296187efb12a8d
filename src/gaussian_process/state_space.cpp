// Observations sorted by the input, filtered, and returned to their order.
#include "gaussian_process/state_space.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "gaussian_process/kalman.hpp"

namespace sysid::gaussian_process {
namespace {

/// Observations and places in the order of their input, observations first where inputs are equal.
struct Ordered {
  Instants instants;
  std::vector<Eigen::Index> order;  // of each instant, its number among observations and then places
};

Ordered ordered(Eigen::VectorXd const& observed, Eigen::VectorXd const& places, Eigen::MatrixXd const& to_filter) {
  Eigen::Index const known = observed.size(), count = known + places.size();
  Ordered result;
  result.order.resize(static_cast<std::size_t>(count));
  std::iota(result.order.begin(), result.order.end(), 0);
  auto const time = [&](Eigen::Index i) { return i < known ? observed[i] : places[i - known]; };
  std::stable_sort(result.order.begin(), result.order.end(), [&](Eigen::Index a, Eigen::Index b) { return time(a) < time(b); });
  result.instants.observations = Eigen::MatrixXd::Zero(to_filter.cols(), count);
  result.instants.steps.assign(result.order.size(), 0);
  result.instants.observed.assign(result.order.size(), 0);
  for (std::size_t n = 0; n < result.order.size(); ++n) {
    Eigen::Index const i = result.order[n];
    if (n > 0) result.instants.steps[n] = time(i) - time(result.order[n - 1]);
    if (i >= known) continue;
    result.instants.observed[n] = 1;
    result.instants.observations.col(static_cast<Eigen::Index>(n)) = to_filter.row(i).transpose();
  }
  return result;
}

/// What the filter whitened, a row per observation.
Eigen::MatrixXd whitened_rows(Filtered const& filtered, Ordered const& ordered, Eigen::Index known) {
  Eigen::MatrixXd result(known, filtered.whitened.rows());
  for (std::size_t n = 0; n < ordered.order.size(); ++n)
    if (ordered.order[n] < known) result.row(ordered.order[n]) = filtered.whitened.col(static_cast<Eigen::Index>(n)).transpose();
  return result;
}

}  // namespace

Marginal state_space_marginal(Covariance const& covariance, Observations const& observations, Numbers parameters,
                              bool with_gradient) {
  double const noise = parameters.back();
  StateSpaceModel model(covariance, parameters.first(parameters.size() - 1));
  Ordered const in_order = ordered(observations.inputs.col(model.column()), {}, to_be_whitened(observations));
  Filtered const filtered = filter(model, in_order.instants, noise * noise);
  Marginal result;
  result.log_likelihood = -std::numeric_limits<double>::infinity();
  if (!filtered.fine) {
    result.outcome = Outcome::not_positive_definite;
    return result;
  }
  Eigen::Index const count = observations.values.size(), columns = observations.columns.cols();
  LinearMean const mean(observations, whitened_rows(filtered, in_order, count), filtered.log_determinant);
  result.outcome = mean.outcome;
  if (mean.outcome != Outcome::fine) return result;
  result.log_likelihood = mean.log_likelihood;
  if (!with_gradient) return result;

  // The derivatives of -1/2 (|e|^2 + |S^-1 d|^2) - log |R| in z and V: -e and e d^T - V (R^T R)^-1.
  Eigen::MatrixXd by_row(count, 1 + columns);
  by_row.col(0) = -mean.residual;
  if (columns > 0)
    by_row.rightCols(columns) = mean.residual * mean.shift.transpose() -
                                mean.triangle.triangularView<Eigen::Upper>().solve(mean.basis.transpose()).transpose();
  Eigen::MatrixXd weights(1 + columns, count);
  for (std::size_t n = 0; n < in_order.order.size(); ++n)
    weights.col(static_cast<Eigen::Index>(n)) = by_row.row(in_order.order[n]).transpose();
  FilterGradient const gradient = filter_gradient(model, in_order.instants, filtered, weights);
  result.gradient.resize(static_cast<Eigen::Index>(parameters.size()));
  std::copy(gradient.parameters.begin(), gradient.parameters.end(), result.gradient.begin());
  result.gradient[result.gradient.size() - 1] = 2 * noise * noise * gradient.noise_variance;
  result.values_gradient.resize(count);
  for (std::size_t n = 0; n < in_order.order.size(); ++n)
    result.values_gradient[in_order.order[n]] = gradient.observations(0, static_cast<Eigen::Index>(n));
  if (!result.gradient.allFinite()) result.outcome = Outcome::not_finite;
  return result;
}

StateSpacePosterior state_space_posterior(Covariance const& covariance, Observations const& observations, Numbers parameters,
                                          Places const& places) {
  double const noise = parameters.back();
  StateSpaceModel model(covariance, parameters.first(parameters.size() - 1));
  Ordered const in_order =
      ordered(observations.inputs.col(model.column()), places.inputs.col(model.column()), to_be_whitened(observations));
  Filtered const filtered = filter(model, in_order.instants, noise * noise);
  StateSpacePosterior result;
  if (!filtered.fine) {
    result.outcome = Outcome::not_positive_definite;
    return result;
  }
  Eigen::Index const known = observations.values.size(), columns = observations.columns.cols(), count = places.inputs.rows();
  LinearMean const mean(observations, whitened_rows(filtered, in_order, known), filtered.log_determinant);
  result.outcome = mean.outcome;
  result.log_likelihood = mean.log_likelihood;
  if (mean.outcome != Outcome::fine) return result;
  result.coefficients = mean.coefficients(observations);
  Smoothed const smoothed = smooth(model, in_order.instants, filtered);
  result.prediction = {Eigen::VectorXd(count), Eigen::VectorXd(count)};
  Eigen::MatrixXd left_over(count, columns);  // of the places' columns, what the observations' do not explain
  for (std::size_t n = 0; n < in_order.order.size(); ++n) {
    Eigen::Index const i = in_order.order[n] - known, instant = static_cast<Eigen::Index>(n);
    if (i < 0) continue;
    result.prediction.mean[i] = smoothed.means(0, instant);
    result.prediction.variance[i] = smoothed.variances[instant];
    if (columns > 0) left_over.row(i) = places.columns.row(i) - smoothed.means.col(instant).tail(columns).transpose();
  }
  if (columns > 0) {
    result.prediction.mean += left_over * mean.shift + places.columns * observations.prior_mean;
    result.prediction.variance += mean.scaled(left_over).colwise().squaredNorm().transpose();
  }
  result.prediction.variance = result.prediction.variance.cwiseMax(0.0);
  return result;
}

}  // namespace sysid::gaussian_process
