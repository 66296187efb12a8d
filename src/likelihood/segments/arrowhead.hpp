// Least squares over coefficients that all segments share and start states that each has of its own: the normal equations have the
// shape of an arrowhead, and the starts are eliminated segment by segment.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "likelihood/segments/segments.hpp"

namespace sysid {

/// A segment whose rows were turned so that d of them know its start [d]:
///
///   start = -upper^-1 (right + cross * coefficients)
///
/// Both are moves from where the slopes were taken; k coefficients. Without states all but `left` is empty.
struct EliminatedSegment {
  Eigen::MatrixXd upper, cross;  // [d x d], [d x k]
  Eigen::VectorXd right;         // [d]
  Eigen::MatrixXd left;          // [rows x k + 1], what is left for the coefficients alone, the last column the residual

  /// The best move of the start [d] when the coefficients move so far.
  Eigen::VectorXd start(Eigen::VectorXd const& coefficients) const;
  /// [d x k]: how the best start moves with the coefficients.
  Eigen::MatrixXd follows() const;
};

/// By QR. damping: relative to the squared length of each start's own column (Marquardt 1963). A start that the segment does not
/// show stays where it is.
EliminatedSegment eliminate(SegmentSlopes const& slopes, double damping);

/// What all segments say of the coefficients.
struct Arrowhead {
  std::vector<EliminatedSegment> segments;  // `left` is empty
  Eigen::MatrixXd triangle;                 // [k + 1 x k + 1], upper: R of all rows that were left, the last column the residual
};

/// slopes: rows in units of their noise, one segment or more. A coefficient that no segment shows stays where it is.
Arrowhead reduce(std::vector<SegmentSlopes> const& slopes, double damping);

/// To the least of the damped squares.
struct ShootingMove {
  Eigen::VectorXd coefficients;  // [k]
  Eigen::MatrixXd starts;        // [d x segments]
  double gain = 0;               // of log likelihood, to first order in the residuals
};

/// slopes: those that were reduced.
ShootingMove move_of(std::vector<SegmentSlopes> const& slopes, Arrowhead const& reduced);

}  // namespace sysid
