// A prior with long tails in place of a normal one: neither weak terms nor large ones are ruled out.
#include "likelihood/segments/coefficient_prior.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numeric/elementary.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid {
namespace {

constexpr double prior_scale = 1.5;  // of the logarithm of a coefficient

}  // namespace

double signal_of(double samples, double variance_ratio) { return std::sqrt(1 + samples * variance_ratio); }

double log_coefficient_weight(Eigen::VectorXd const& estimate, Eigen::MatrixXd const& upper, double signal, int others) {
  Eigen::Index const k = estimate.size();
  if (k == 0) return 0;
  Eigen::MatrixXd const inverse = solve_upper(upper, Eigen::MatrixXd::Identity(k, k));
  double sum = static_cast<double>(k) / 2 * elementary::log(2 * std::numbers::pi);
  for (Eigen::Index j = 0; j < k; ++j) {
    sum -= elementary::log(std::abs(upper(j, j)));
    if (j >= k - others) continue;
    double const size = std::max(std::abs(estimate(j)), inverse.row(j).norm());
    sum -= elementary::log(4 * prior_scale * size) + std::abs(elementary::log(size * upper.col(j).norm() / signal)) / prior_scale;
  }
  return sum;
}

}  // namespace sysid
