// Metrics and their estimates.
#include "inference/nuts/metric.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid::nuts {
namespace {

constexpr std::uint64_t least_moves = 10;
constexpr double prior_draws = 5;  // the metric in use counts for as many

/// What a variance `found` in units of the metric says, where chance alone leaves those between `low` and `high`.
double learnt(double found, double low, double high, double states) {
  if (found >= low && found <= high) return 1;
  return elementary::exp(states / (states + prior_draws) * elementary::log(std::max(found, 1e-12)));
}

}  // namespace

void Metric::velocity(std::span<double const> momentum, std::span<double> out) const {
  auto const n = static_cast<std::size_t>(dimension);
  for (std::size_t i = 0; i < n; ++i) {
    if (!dense) {
      out[i] = factor[i] * momentum[i];
      continue;
    }
    double sum = 0;
    for (std::size_t j = 0; j <= i; ++j) sum += factor[i * n + j] * momentum[j];
    out[i] = sum;
  }
}

void Metric::force(std::span<double const> gradient, std::span<double> out) const {
  auto const n = static_cast<std::size_t>(dimension);
  for (std::size_t j = 0; j < n; ++j) out[j] = dense ? 0 : factor[j] * gradient[j];
  for (std::size_t i = 0; dense && i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j) out[j] += factor[i * n + j] * gradient[i];
}

void Metric::whiten(std::span<double> x) const {
  auto const n = static_cast<std::size_t>(dimension);
  for (std::size_t i = 0; i < n; ++i) {
    if (!dense) {
      x[i] /= factor[i];
      continue;
    }
    for (std::size_t j = 0; j < i; ++j) x[i] -= factor[i * n + j] * x[j];
    x[i] /= factor[i * n + i];
  }
}

Metric metric_of(Eigen::MatrixXd const& covariance, bool dense) {
  Eigen::Index const n = covariance.rows();
  Metric metric{static_cast<int>(n), dense, {}};
  if (!dense) {
    for (Eigen::Index i = 0; i < n; ++i) metric.factor.push_back(std::sqrt(covariance(i, i)));
    return metric;
  }
  Eigen::MatrixXd const factor = cholesky_or_diagonal(covariance);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) metric.factor.push_back(j <= i ? factor(i, j) : 0);
  return metric;
}

void WindowOfDraws::add(Metric const& metric, std::span<double const> theta, bool moved) {
  std::size_t const n = theta.size();
  if (count_ == 0) {
    reference_.assign(theta.begin(), theta.end());
    mean_.assign(n, 0);
    squares_.assign(metric.dense ? n * n : n, 0);
  }
  ++count_;
  moves_ += moved ? 1 : 0;
  std::vector<double> step(n);
  for (std::size_t i = 0; i < n; ++i) step[i] = theta[i] - reference_[i];
  metric.whiten(step);
  for (std::size_t i = 0; i < n; ++i) step[i] -= mean_[i];
  double const share = 1 / static_cast<double>(count_);
  // West 1979: sum of products about the mean of all so far.
  for (std::size_t i = 0; i < n; ++i) {
    if (metric.dense)
      for (std::size_t j = 0; j < n; ++j) squares_[i * n + j] += (1 - share) * step[i] * step[j];
    else
      squares_[i] += (1 - share) * step[i] * step[i];
  }
  for (std::size_t i = 0; i < n; ++i) mean_[i] += share * step[i];
}

bool WindowOfDraws::fits(Metric const& metric) const {
  std::size_t const n = count_ > 0 ? static_cast<std::size_t>(metric.dimension) : 0;
  return reference_.size() == n && mean_.size() == n && squares_.size() == (metric.dense ? n * n : n);
}

Metric WindowOfDraws::estimate(Metric const& metric) const {
  if (moves_ < least_moves) return metric;
  auto const n = static_cast<Eigen::Index>(metric.dimension);
  auto const states = static_cast<double>(std::min(count_, moves_ + 1));  // a state that stayed tells nothing new
  double const ratio = std::sqrt(2 * (metric.dense ? static_cast<double>(n) : 1) / states);
  // Fewer states than directions leave some of these out: a variance of 0, or less by rounding, contradicts nothing.
  double const low = ratio < 1 ? (1 - ratio) * (1 - ratio) : -infinity, high = (1 + ratio) * (1 + ratio);
  auto const counted = static_cast<double>(count_);
  Metric next = metric;
  if (!metric.dense) {
    for (std::size_t i = 0; i < next.factor.size(); ++i)
      next.factor[i] *= std::sqrt(learnt(squares_[i] / (counted - 1), low, high, states));
    return next;
  }
  Eigen::MatrixXd const covariance = Eigen::Map<Eigen::MatrixXd const>(squares_.data(), n, n) / (counted - 1);
  SymmetricEigen shape = symmetric_eigen(covariance);
  for (double& value : shape.values) value = learnt(value, low, high, states);
  if ((shape.values.array() == 1).all()) return metric;
  auto const inner = cholesky(shape.vectors * shape.values.asDiagonal() * shape.vectors.transpose());
  if (!inner) return metric;
  Eigen::MatrixXd outer = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j <= i; ++j) outer(i, j) = metric.factor[static_cast<std::size_t>(i * n + j)];
  Eigen::MatrixXd const product = outer * *inner;
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j <= i; ++j) next.factor[static_cast<std::size_t>(i * n + j)] = product(i, j);
  return next;
}

}  // namespace sysid::nuts
