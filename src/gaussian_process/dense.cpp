// Cholesky factors with jitter, the marginal likelihood, and prediction by them.
#include "gaussian_process/dense.hpp"

#include <cmath>
#include <functional>
#include <limits>

#include "core/numeric/elementary.hpp"
#include "linear_algebra/lapack.hpp"

namespace sysid::gaussian_process {
namespace {

/// Matrices of this many columns at once when predicting: bounds the memory.
constexpr Eigen::Index block = 512;

using Factor = PriorFactor;

/// The Cholesky factor of the matrix whose lower triangle `fill` writes, with as little jitter as the policy needs; `fill` returns
/// what the jitter is relative to.
Factor factor(Eigen::Index size, std::function<double(Eigen::MatrixXd&)> const& fill, Jitter const& policy) {
  Factor result{Eigen::MatrixXd(size, size), 0, false};
  for (double jitter = 0; jitter <= policy.most * (1 + 1e-9); jitter = jitter == 0 ? policy.first : jitter * policy.growth) {
    double const scale = fill(result.lower);
    result.jitter = jitter;
    result.lower.diagonal().array() += jitter * scale;
    result.fine = lapack::cholesky(result.lower) && result.lower.diagonal().allFinite();
    if (result.fine || !(policy.first > 0)) break;
  }
  return result;
}

Factor factor(Covariance const& covariance, Eigen::MatrixXd const& inputs, Numbers parameters, Jitter const& policy) {
  double const noise = parameters.back();
  return factor(
      inputs.rows(),
      [&](Eigen::MatrixXd& out) {
        covariance.fill_lower(inputs, parameters.first(parameters.size() - 1), out);
        out.diagonal().array() += noise * noise;
        return out.diagonal().mean();
      },
      policy);
}

double log_determinant(Eigen::MatrixXd const& lower) {
  double sum = 0;
  for (Eigen::Index i = 0; i < lower.rows(); ++i) sum += elementary::log(lower(i, i));
  return 2 * sum;
}

}  // namespace

PriorFactor prior_factor(Covariance const& covariance, Eigen::MatrixXd const& inputs, Numbers parameters, Jitter const& jitter) {
  return factor(
      inputs.rows(),
      [&](Eigen::MatrixXd& out) {
        covariance.fill_lower(inputs, parameters, out);
        return out.diagonal().mean();
      },
      jitter);
}

PriorFactor observed_factor(Covariance const& covariance, Eigen::MatrixXd const& inputs, Numbers parameters, Jitter const& jitter) {
  return factor(covariance, inputs, parameters, jitter);
}

Marginal dense_marginal(Covariance const& covariance, Observations const& observations, Numbers parameters, bool with_gradient,
                        Jitter const& policy) {
  Marginal result;
  result.log_likelihood = -std::numeric_limits<double>::infinity();
  Factor factored = factor(covariance, observations.inputs, parameters, policy);
  result.jitter = factored.jitter;
  if (!factored.fine) {
    result.outcome = Outcome::not_positive_definite;
    return result;
  }
  Eigen::MatrixXd& matrix = factored.lower;
  Eigen::MatrixXd whitened = to_be_whitened(observations);
  lapack::solve_lower(matrix, whitened);
  LinearMean mean(observations, whitened, log_determinant(matrix));
  result.outcome = mean.outcome;
  if (mean.outcome != Outcome::fine) return result;
  result.log_likelihood = mean.log_likelihood;
  if (!with_gradient) return result;

  // matrix becomes P - alpha alpha^T, lower triangle.
  Eigen::MatrixXd alpha = mean.residual;
  lapack::solve_lower_transposed(matrix, alpha);
  if (mean.basis.cols() > 0) lapack::solve_lower_transposed(matrix, mean.basis);
  lapack::invert_cholesky(matrix);
  lapack::add_outer(-1, alpha, matrix);
  if (mean.basis.cols() > 0) lapack::add_outer(-1, mean.basis, matrix);
  double const trace = matrix.diagonal().sum(), noise = parameters.back();
  // The jitter is a share of the mean diagonal, so it moves with the hyper-parameters.
  matrix.diagonal().array() += result.jitter * trace / static_cast<double>(matrix.rows());
  result.gradient.resize(static_cast<Eigen::Index>(parameters.size()));
  result.gradient.head(result.gradient.size() - 1) =
      -0.5 * covariance.gradient(observations.inputs, parameters.first(parameters.size() - 1), matrix);
  result.gradient[result.gradient.size() - 1] = -noise * noise * matrix.diagonal().sum();
  result.values_gradient = -alpha;
  if (!result.gradient.allFinite()) result.outcome = Outcome::not_finite;
  return result;
}

DensePosterior::DensePosterior(Covariance covariance, Observations observations, std::vector<double> parameters,
                               Jitter const& jitter)
    : covariance_(std::move(covariance)),
      observations_(std::move(observations)),
      parameters_(std::move(parameters)),
      policy_(jitter) {
  Factor factored = factor(covariance_, observations_.inputs, parameters_, policy_);
  jitter_ = factored.jitter;
  if (!factored.fine) {
    mean_.outcome = Outcome::not_positive_definite;
    return;
  }
  lower_ = std::move(factored.lower);
  Eigen::MatrixXd whitened = to_be_whitened(observations_);
  lapack::solve_lower(lower_, whitened);
  mean_ = LinearMean(observations_, whitened, log_determinant(lower_));
  if (mean_.outcome != Outcome::fine) return;
  whitened_ = whitened.rightCols(whitened.cols() - 1);
  Eigen::MatrixXd alpha = mean_.residual;
  lapack::solve_lower_transposed(lower_, alpha);
  alpha_ = alpha.col(0);
}

DensePosterior::Reach DensePosterior::reach(Places const& places, Eigen::MatrixXd cross) const {
  Reach result{std::move(cross), Eigen::MatrixXd(0, places.inputs.rows())};
  lapack::solve_lower(lower_, result.known);
  if (whitened_.cols() > 0) {
    Eigen::MatrixXd const explained = lapack::inner(result.known, whitened_);
    result.coefficients = mean_.scaled(places.columns - explained);
  }
  return result;
}

Prediction DensePosterior::predict(Places const& places) const {
  Eigen::Index const count = places.inputs.rows();
  Numbers const parameters = Numbers(parameters_).first(parameters_.size() - 1);
  Prediction result{Eigen::VectorXd(count), covariance_.variances(places.inputs, parameters)};
  for (Eigen::Index first = 0; first < count; first += block) {
    Eigen::Index const size = std::min(block, count - first);
    Places some{places.inputs.middleRows(first, size), {}};
    if (whitened_.cols() > 0) some.columns = places.columns.middleRows(first, size);
    Eigen::MatrixXd cross = covariance_.between(observations_.inputs, some.inputs, parameters);
    result.mean.segment(first, size) = cross.transpose() * alpha_;
    if (whitened_.cols() > 0) result.mean.segment(first, size) += some.columns * (observations_.prior_mean + mean_.shift);
    Reach const reached = reach(some, std::move(cross));
    result.variance.segment(first, size) -= reached.known.colwise().squaredNorm().transpose();
    if (whitened_.cols() > 0) result.variance.segment(first, size) += reached.coefficients.colwise().squaredNorm().transpose();
  }
  result.variance = result.variance.cwiseMax(0.0);
  return result;
}

Eigen::MatrixXd DensePosterior::covariance(Places const& places) const {
  Numbers const parameters = Numbers(parameters_).first(parameters_.size() - 1);
  Eigen::MatrixXd result(places.inputs.rows(), places.inputs.rows());
  covariance_.fill_lower(places.inputs, parameters, result);
  Reach const reached = reach(places, covariance_.between(observations_.inputs, places.inputs, parameters));
  lapack::add_inner(-1, reached.known, result);
  if (whitened_.cols() > 0) lapack::add_inner(1, reached.coefficients, result);
  result.triangularView<Eigen::StrictlyUpper>() = result.transpose();
  return result;
}

DensePosterior::Samples DensePosterior::sample(Places const& places, int count, StreamKey key) const {
  Eigen::VectorXd const mean = predict(places).mean;
  Eigen::MatrixXd const spread = covariance(places);
  // What is known exactly has variance 0 up to rounding, which is as large as the prior's variances make it.
  double const prior = covariance_.variances(places.inputs, Numbers(parameters_).first(parameters_.size() - 1)).mean();
  Factor const factored = factor(
      spread.rows(),
      [&](Eigen::MatrixXd& out) {
        out = spread;
        return prior;
      },
      policy_);
  if (!factored.fine) return {Eigen::MatrixXd(mean.size(), 0), factored.jitter};
  Samples result{Eigen::MatrixXd(mean.size(), count), factored.jitter};
  Eigen::VectorXd normal(mean.size());
  for (int draw = 0; draw < count; ++draw) {
    Stream stream(key.with_index(static_cast<std::uint64_t>(draw)));
    for (double& one : normal) one = stream.normal();
    result.functions.col(draw) = mean + factored.lower.triangularView<Eigen::Lower>() * normal;
  }
  return result;
}

}  // namespace sysid::gaussian_process
