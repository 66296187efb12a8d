// Exponentials in lanes, sums in the centres' order.
#include "inference/abc/kernel_numerics.hpp"

#include <cmath>
#include <numbers>

#include "core/numeric/elementary.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid::abc {

double weighted_exponentials(std::span<double> square, std::span<double const> weight) {
  for (double& value : square) value *= -0.5;
  elementary::exp_lanes(square.data(), square.data(), static_cast<int>(square.size()));
  double part[4] = {0, 0, 0, 0};
  for (std::size_t j = 0; j < square.size(); ++j) part[j % 4] += weight[j] * square[j];
  return (part[0] + part[1]) + (part[2] + part[3]);
}

Eigen::MatrixXd scaled_factor(double scale, Eigen::MatrixXd const& covariance) {
  if (auto factor = cholesky(scale * covariance)) return *std::move(factor);
  return std::sqrt(scale) * cholesky_or_diagonal(covariance);
}

double log_normaliser(Eigen::MatrixXd const& factor) {
  double log = -0.5 * static_cast<double>(factor.rows()) * elementary::log(2 * std::numbers::pi);
  for (Eigen::Index d = 0; d < factor.rows(); ++d) log -= elementary::log(factor(d, d));
  return log;
}

void move_from(ConstLanes at, int centre, Eigen::MatrixXd const& factor, Lanes out, int lane) {
  // From the last row up: a row reads the rows before it.
  for (int d = out.rows() - 1; d >= 0; --d) {
    double value = at(d, centre);
    for (int e = 0; e <= d; ++e) value += factor(d, e) * out(e, lane);
    out(d, lane) = value;
  }
}

}  // namespace sysid::abc
