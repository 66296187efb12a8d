// Elimination of the start states, the reduced equations, and the move back to all unknowns.
#include "likelihood/segments/arrowhead.hpp"

#include <cmath>
#include <utility>

#include "linear_algebra/decompositions.hpp"

namespace sysid {
namespace {

constexpr double ridge = 1e-12;  // on starts, of their own column: those that a segment does not show stay where they are

}  // namespace

Eigen::VectorXd EliminatedSegment::start(Eigen::VectorXd const& coefficients) const {
  return upper.triangularView<Eigen::Upper>().solve(-right - cross * coefficients);
}

Eigen::MatrixXd EliminatedSegment::follows() const { return solve_upper(upper, -cross); }

EliminatedSegment eliminate(SegmentSlopes const& slopes, double damping) {
  Eigen::Index const n = slopes.residual.size(), d = slopes.by_start.cols(), k = slopes.by_coefficient.cols();
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(n + d, d), others = Eigen::MatrixXd::Zero(n + d, k + 1);
  columns.topRows(n) = slopes.by_start;
  others.topLeftCorner(n, k) = slopes.by_coefficient;
  others.topRightCorner(n, 1) = slopes.residual;
  for (Eigen::Index x = 0; x < d; ++x) {
    double const norm = slopes.by_start.col(x).norm();
    columns(n + x, x) = norm > 0 ? std::sqrt(ridge + damping) * norm : 1;
  }
  EliminatedSegment out;
  if (d == 0) {
    out.left = std::move(others);
    return out;
  }
  OrthogonalTriangular const factored(columns);
  Eigen::MatrixXd const turned = factored.turned(others);
  out.upper = factored.triangle();
  out.cross = turned.topLeftCorner(d, k);
  out.right = turned.topRightCorner(d, 1);
  out.left = turned.bottomRows(n);
  return out;
}

Arrowhead reduce(std::vector<SegmentSlopes> const& slopes, double damping) {
  Arrowhead out;
  Eigen::Index const k = slopes.front().by_coefficient.cols();
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(k);
  out.triangle = Eigen::MatrixXd::Zero(k + 1, k + 1);
  for (SegmentSlopes const& each : slopes) {
    out.segments.push_back(eliminate(each, damping));
    Eigen::MatrixXd& left = out.segments.back().left;
    Eigen::MatrixXd stacked(out.triangle.rows() + left.rows(), k + 1);
    stacked << out.triangle, left;
    out.triangle = OrthogonalTriangular(stacked).triangle();
    squares += each.by_coefficient.colwise().squaredNorm().transpose();
    left.resize(0, 0);
  }
  Eigen::MatrixXd damped = Eigen::MatrixXd::Zero(2 * k + 1, k + 1);
  damped.topRows(k + 1) = out.triangle;
  for (Eigen::Index j = 0; j < k; ++j) damped(k + 1 + j, j) = squares(j) > 0 ? std::sqrt(damping * squares(j)) : 1;
  if (damping > 0 || squares.size() == 0 || squares.minCoeff() == 0) out.triangle = OrthogonalTriangular(damped).triangle();
  return out;
}

ShootingMove move_of(std::vector<SegmentSlopes> const& slopes, Arrowhead const& reduced) {
  Eigen::Index const k = slopes.front().by_coefficient.cols(), d = slopes.front().by_start.cols();
  ShootingMove move;
  move.coefficients = k == 0 ? Eigen::VectorXd()
                             : Eigen::VectorXd(reduced.triangle.topLeftCorner(k, k).triangularView<Eigen::Upper>().solve(
                                   Eigen::VectorXd(-reduced.triangle.topRightCorner(k, 1))));
  move.starts.resize(d, static_cast<Eigen::Index>(slopes.size()));
  for (std::size_t s = 0; s < slopes.size(); ++s) {
    auto const i = static_cast<Eigen::Index>(s);
    Eigen::VectorXd after = slopes[s].residual + slopes[s].by_coefficient * move.coefficients;
    if (d > 0) {
      move.starts.col(i) = reduced.segments[s].start(move.coefficients);
      after += slopes[s].by_start * move.starts.col(i);
    }
    move.gain += (slopes[s].residual.squaredNorm() - after.squaredNorm()) / 2;
  }
  return move;
}

}  // namespace sysid
