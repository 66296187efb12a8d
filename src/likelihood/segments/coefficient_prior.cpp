// A log-uniform prior in place of a normal one: the width of a normal prior would have to be known.
#include "likelihood/segments/coefficient_prior.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numeric/elementary.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid {

double scales_shown(double samples, double variance_ratio) {
  return std::max(1.0, elementary::log(1 + samples * variance_ratio) / 2);
}

double log_coefficient_weight(Eigen::VectorXd const& estimate, Eigen::MatrixXd const& upper, double scales) {
  Eigen::Index const k = estimate.size();
  if (k == 0) return 0;
  Eigen::MatrixXd const inverse = solve_upper(upper, Eigen::MatrixXd::Identity(k, k));
  double sum = static_cast<double>(k) / 2 * elementary::log(2 * std::numbers::pi);
  for (Eigen::Index j = 0; j < k; ++j)
    sum -= elementary::log(2 * scales * std::max(std::abs(estimate(j)), inverse.row(j).norm())) +
           elementary::log(std::abs(upper(j, j)));
  return sum;
}

}  // namespace sysid
