// Noise whose samples depend on each other: a moving average of independent numbers, estimated and removed.
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

namespace sysid::regression {

/// Rows that follow one another: [first, first + count).
struct Run {
  Eigen::Index first = 0, count = 0;
};

/// v_i = e_i + c_1 e_i-1 + ... + c_q e_i-q, e independent, C(z) = 1 + c_1 z + ... without a zero inside or on the unit circle.
struct MovingAverage {
  std::vector<double> coefficients;  // c_1, ...; empty: white

  /// e of some v, column by column: v divided by C, from e = 0 before each run.
  Eigen::MatrixXd divided(Eigen::MatrixXd const& v, std::span<Run const> runs) const;
  /// The derivatives of -e by c_1, ..., c_q: e_i-k divided by C. [rows x q]; e: what `divided` gives of v.
  Eigen::MatrixXd slopes(Eigen::VectorXd const& e, std::span<Run const> runs) const;
};

/// From these coefficients on to the least sum of squared e: the conditional maximum of the likelihood, by the Gauss-Newton method
/// (Box, Jenkins 1976, ch. 7). Zeros of the first polynomial that lie near the unit circle or inside are moved out.
MovingAverage fitted_moving_average(Eigen::VectorXd const& v, std::span<Run const> runs, MovingAverage from);

}  // namespace sysid::regression
