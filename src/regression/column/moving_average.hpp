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

/// v_i = e_i + c_1 e_i-1 + ... + c_q e_i-q, e independent and of one sd, those before a run as well, C(z) = 1 + c_1 z + ... without
/// a zero inside or on the unit circle.
///
/// With E the numbers v divided by C from e = 0 before a run, and R what errors of 1 before it do to them, the covariance of E is
/// sd^2 (I + R R^T): exactly that of v.
struct MovingAverage {
  std::vector<double> coefficients;  // c_1, ...; empty: white

  Eigen::Index order() const { return static_cast<Eigen::Index>(coefficients.size()); }
  /// e of some v [rows], and those before each run [q x runs], the last one first: with the least sum of squares of all of them.
  struct Errors {
    Eigen::VectorXd in_runs;
    Eigen::MatrixXd before;
    double squares() const { return in_runs.squaredNorm() + before.squaredNorm(); }
  };
  Errors errors(Eigen::VectorXd const& v, std::span<Run const> runs) const;
  /// The derivatives of -e by c_1, ..., c_q: e_i-k divided by C, from 0 before each run. [rows x q]
  Eigen::MatrixXd slopes(Errors const& e, std::span<Run const> runs) const;
  Eigen::MatrixXd divided(Eigen::MatrixXd const& columns, std::span<Run const> runs) const;
  /// Columns that are divided by C, turned so that their errors are independent. [rows x columns]
  Eigen::MatrixXd turned(Eigen::MatrixXd const& divided, std::span<Run const> runs) const;
  /// The same, with errors before a run that may be anything: samples before it, which regressors hold, depend on them. q rows of
  /// each run are lost.
  Eigen::MatrixXd freed(Eigen::MatrixXd const& divided, std::span<Run const> runs) const;
  /// log of the determinant of I + R R^T, summed over runs.
  double log_determinant(std::span<Run const> runs) const;
};

/// From these coefficients on to the least n log(sum of squares) + log determinant, the maximum of the likelihood, by the
/// Gauss-Newton method (Box, Jenkins 1976, ch. 7). Zeros of the first polynomial that lie near the unit circle or inside are moved
/// out.
MovingAverage fitted_moving_average(Eigen::VectorXd const& v, std::span<Run const> runs, MovingAverage from);

}  // namespace sysid::regression
