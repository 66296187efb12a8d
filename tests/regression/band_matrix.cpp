// The banded factorisation against the dense one.
#include "linear_algebra/band_matrix.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>

#include "core/numeric/random.hpp"
#include "linear_algebra/decompositions.hpp"

using namespace sysid;
using regression::BandMatrix;

TEST_CASE("a band matrix factors and solves like the dense one") {
  int const n = 30, band = 4;
  Stream stream({3, Purpose::test, 0, 0});
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);
  BandMatrix matrix(n, band);
  for (int j = 0; j < n; ++j)
    for (int i = j; i < n && i <= j + band; ++i) {
      double const value = stream.normal() + (i == j ? 12 : 0);
      matrix(i, j) = dense(i, j) = dense(j, i) = value;
    }
  Eigen::MatrixXd right(n, 2);
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 2; ++k) right(i, k) = stream.normal();
  REQUIRE(matrix.factor());
  Eigen::MatrixXd lower = right;
  matrix.solve_lower(lower);
  Eigen::MatrixXd const factor = *cholesky(dense);
  CHECK((factor * lower - right).norm() < 1e-12);
  matrix.solve_upper(lower);
  CHECK((dense * lower - right).norm() < 1e-12);
}

TEST_CASE("a matrix that is not positive definite does not factor") {
  BandMatrix matrix(2, 1);
  matrix(0, 0) = matrix(1, 1) = 1;
  matrix(1, 0) = 2;
  CHECK_FALSE(matrix.factor());
}
