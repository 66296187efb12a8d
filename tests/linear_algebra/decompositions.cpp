// Decompositions against what defines them, and sums that no processor may cut its own way.
#include "linear_algebra/decompositions.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace sysid;

namespace {

// Entries without a pattern.
Eigen::MatrixXd some(Eigen::Index rows, Eigen::Index columns) {
  Eigen::MatrixXd matrix(rows, columns);
  for (Eigen::Index j = 0; j < columns; ++j)
    for (Eigen::Index i = 0; i < rows; ++i)
      matrix(i, j) = std::sin(1.7 * static_cast<double>(i * i + 3 * j) + static_cast<double>(j));
  return matrix;
}

Eigen::MatrixXd definite(Eigen::Index size) {
  Eigen::MatrixXd const root = some(size, size);
  return root * root.transpose() + Eigen::MatrixXd::Identity(size, size);
}

double gap(Eigen::MatrixXd const& a, Eigen::MatrixXd const& b) { return (a - b).cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("the caches that products are cut to are those of one processor, whatever this one has") {
  CHECK(Eigen::l1CacheSize() == 32 * 1024);
  CHECK(Eigen::l2CacheSize() == 256 * 1024);
  CHECK(Eigen::l3CacheSize() == 2048 * 1024);
}

TEST_CASE("factors multiply to the matrix") {
  Eigen::MatrixXd const a = definite(7);
  auto const [values, vectors] = symmetric_eigen(a);
  CHECK(gap(vectors * values.asDiagonal() * vectors.transpose(), a) < 1e-12);
  CHECK(values(0) <= values(6));
  Eigen::MatrixXd const tall = some(9, 4), wide = tall.transpose();
  SingularValues const svd = singular_values(tall);
  CHECK(gap(svd.left * svd.values.asDiagonal() * svd.right.transpose(), tall) < 1e-12);
  SingularValues const flat = singular_values(wide);
  CHECK(flat.right.cols() == 9);
  CHECK((wide * flat.right.rightCols(5)).cwiseAbs().maxCoeff() < 1e-12);
  Eigen::MatrixXd const lower = cholesky(a).value();
  CHECK(gap(lower * lower.transpose(), a) < 1e-12);
  CHECK_FALSE(cholesky(-a).has_value());
  OrthogonalTriangular const qr(tall);
  CHECK(gap(qr.basis() * qr.triangle(), tall) < 1e-12);
  CHECK(gap(qr.basis().transpose() * qr.basis(), Eigen::MatrixXd::Identity(4, 4)) < 1e-12);
  CHECK(gap(qr.turned(tall).topRows(4), qr.triangle()) < 1e-12);
  CHECK(qr.turned(tall).bottomRows(5).cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("solutions solve, determinants agree") {
  Eigen::MatrixXd const a = definite(6), right = some(6, 2), tall = some(9, 4);
  Eigen::VectorXd const one = right.col(0);
  CHECK(gap(a * solve_symmetric(a, one), one) < 1e-12);
  CHECK(gap(a * inverse(a), Eigen::MatrixXd::Identity(6, 6)) < 1e-12);
  Eigen::MatrixXd const lower = cholesky(a).value();
  CHECK(gap(a * solve_cholesky(lower, right), right) < 1e-12);
  CHECK(log_absolute_determinant(a) == doctest::Approx(2 * lower.diagonal().array().log().sum()));
  Eigen::MatrixXd const upper = lower.transpose();
  CHECK(gap(upper * solve_upper(upper, right), right) < 1e-12);
  for (auto const& solve : {solve_upper, solve_cholesky}) CHECK(solve(upper, Eigen::MatrixXd(6, 0)).cols() == 0);
  // The residual of least squares is orthogonal to the columns.
  Eigen::MatrixXd const known = some(9, 1), best = OrthogonalTriangular(tall).solve(known);
  CHECK((tall.transpose() * (known - tall * best)).cwiseAbs().maxCoeff() < 1e-12);
}
