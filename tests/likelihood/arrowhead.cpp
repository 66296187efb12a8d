// Elimination of starts against one dense system, damping included.
#include "likelihood/segments/arrowhead.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>

#include "core/numeric/random.hpp"
#include "linear_algebra/decompositions.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

Eigen::MatrixXd some(Eigen::Index rows, Eigen::Index columns, Stream& stream) {
  Eigen::MatrixXd matrix(rows, columns);
  for (Eigen::Index j = 0; j < columns; ++j)
    for (Eigen::Index i = 0; i < rows; ++i) matrix(i, j) = stream.normal();
  return matrix;
}

constexpr Eigen::Index k = 3, d = 2;

/// Three segments of different lengths.
std::vector<SegmentSlopes> segments() {
  Stream stream({1, Purpose::test, 0, 0});
  std::vector<SegmentSlopes> all;
  for (int s = 0; s < 3; ++s) {
    Eigen::Index const rows = 9 + 4 * s;
    all.push_back({some(rows, 1, stream), some(rows, k, stream), some(rows, d, stream)});
  }
  return all;
}

/// All unknowns, coefficients first: least squares of one matrix over the square roots of the damping.
Eigen::VectorXd dense(std::vector<SegmentSlopes> const& slopes, double damping) {
  Eigen::Index rows = 0;
  auto const unknowns = k + d * static_cast<Eigen::Index>(slopes.size());
  for (SegmentSlopes const& each : slopes) rows += each.residual.size();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(rows + unknowns, unknowns);
  Eigen::VectorXd residual = Eigen::VectorXd::Zero(rows + unknowns);
  Eigen::Index row = 0;
  for (std::size_t s = 0; s < slopes.size(); ++s) {
    Eigen::Index const n = slopes[s].residual.size();
    matrix.block(row, 0, n, k) = slopes[s].by_coefficient;
    matrix.block(row, k + d * static_cast<Eigen::Index>(s), n, d) = slopes[s].by_start;
    residual.segment(row, n) = slopes[s].residual;
    row += n;
  }
  for (Eigen::Index j = 0; j < unknowns; ++j) matrix(rows + j, j) = std::sqrt(damping) * matrix.col(j).head(rows).norm();
  return OrthogonalTriangular(matrix).solve(-residual);
}

}  // namespace

TEST_CASE("a move over eliminated starts is that of one system over all unknowns, damped or not") {
  std::vector<SegmentSlopes> const slopes = segments();
  for (double const damping : {0.0, 1e-3, 2.0}) {
    Eigen::VectorXd const expected = dense(slopes, damping);
    ShootingMove const move = move_of(slopes, reduce(slopes, damping));
    for (Eigen::Index j = 0; j < k; ++j) CHECK(move.coefficients(j) == relative(expected(j), 1e-8));
    double gain = 0;
    for (Eigen::Index s = 0; s < 3; ++s) {
      for (Eigen::Index x = 0; x < d; ++x) CHECK(move.starts(x, s) == relative(expected(k + d * s + x), 1e-8));
      SegmentSlopes const& each = slopes[static_cast<std::size_t>(s)];
      Eigen::VectorXd const after =
          each.residual + each.by_coefficient * expected.head(k) + each.by_start * expected.segment(k + d * s, d);
      gain += (each.residual.squaredNorm() - after.squaredNorm()) / 2;
    }
    CHECK(move.gain == doctest::Approx(gain).epsilon(1e-8));
  }
}

TEST_CASE("the best start follows the coefficients") {
  SegmentSlopes const slopes = segments().front();
  EliminatedSegment const eliminated = eliminate(slopes, 0);
  Eigen::VectorXd const none = Eigen::VectorXd::Zero(k), move = Eigen::VectorXd::LinSpaced(k, 1, 2);
  CHECK((eliminated.start(move) - eliminated.start(none) - eliminated.follows() * move).norm() < 1e-12);
}

TEST_CASE("what no segment shows stays where it is") {
  std::vector<SegmentSlopes> slopes = segments();
  for (SegmentSlopes& each : slopes) each.by_coefficient.col(1).setZero();
  slopes[2].by_start.col(0).setZero();
  ShootingMove const move = move_of(slopes, reduce(slopes, 0));
  CHECK(move.coefficients(1) == 0);
  CHECK(move.starts(0, 2) == 0);
  CHECK(move.coefficients(0) != 0);
}
