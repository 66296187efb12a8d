// The routines of OpenBLAS against their definitions, on parts of larger matrices too.
#include "linear_algebra/lapack.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "core/numeric/random.hpp"

namespace {

using namespace sysid;
using Eigen::MatrixXd;

MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, std::uint64_t index) {
  Stream stream({.seed = 5, .purpose = Purpose::test, .index = index});
  MatrixXd result(rows, columns);
  for (double& one : result.reshaped()) one = stream.normal();
  return result;
}

MatrixXd random_covariance(Eigen::Index size, std::uint64_t index) {
  MatrixXd const root = random_matrix(size, size, index);
  return root * root.transpose() + MatrixXd::Identity(size, size);
}

}  // namespace

TEST_CASE("a Cholesky factor reproduces its matrix and leaves the upper triangle alone") {
  MatrixXd const matrix = random_covariance(70, 1);
  MatrixXd factored = matrix;
  REQUIRE(lapack::cholesky(factored));
  MatrixXd const lower = factored.triangularView<Eigen::Lower>();
  CHECK((lower * lower.transpose() - matrix).norm() < 1e-13 * matrix.norm());
  MatrixXd const above = (factored - matrix).triangularView<Eigen::StrictlyUpper>();
  CHECK(above.norm() == 0);
}

TEST_CASE("a matrix that is not positive definite has no Cholesky factor") {
  MatrixXd matrix = MatrixXd::Identity(5, 5);
  matrix(4, 4) = -1e-3;
  CHECK_FALSE(lapack::cholesky(matrix));
}

TEST_CASE("an inverse from a Cholesky factor, and triangular solves, on blocks of larger matrices") {
  MatrixXd const matrix = random_covariance(40, 2);
  MatrixXd large = MatrixXd::Constant(50, 45, 7);
  large.block(3, 4, 40, 40) = matrix;
  REQUIRE(lapack::cholesky(large.block(3, 4, 40, 40)));
  MatrixXd const lower = large.block(3, 4, 40, 40).triangularView<Eigen::Lower>();
  MatrixXd const right = random_matrix(40, 3, 3);
  MatrixXd solved = right;
  lapack::solve_lower(large.block(3, 4, 40, 40), solved);
  CHECK((lower * solved - right).norm() < 1e-12 * right.norm());
  solved = right;
  lapack::solve_lower_transposed(large.block(3, 4, 40, 40), solved);
  CHECK((lower.transpose() * solved - right).norm() < 1e-12 * right.norm());
  lapack::invert_cholesky(large.block(3, 4, 40, 40));
  MatrixXd const inverse = large.block(3, 4, 40, 40).selfadjointView<Eigen::Lower>();
  CHECK((inverse * matrix - MatrixXd::Identity(40, 40)).norm() < 1e-11);
  CHECK(large.row(2).minCoeff() == 7);
  CHECK(large.col(44).maxCoeff() == 7);
}

TEST_CASE("symmetric updates and inner products") {
  MatrixXd const a = random_matrix(9, 4, 4), b = random_matrix(9, 6, 5);
  CHECK((lapack::inner(a, b) - a.transpose() * b).norm() < 1e-14 * a.norm() * b.norm());
  MatrixXd outer = MatrixXd::Zero(9, 9), inner = MatrixXd::Zero(4, 4);
  lapack::add_outer(2, a, outer);
  lapack::add_inner(-1, a, inner);
  MatrixXd const outer_error = (outer - 2 * a * a.transpose()).triangularView<Eigen::Lower>();
  MatrixXd const inner_error = (inner + a.transpose() * a).triangularView<Eigen::Lower>();
  CHECK(outer_error.norm() < 1e-13);
  CHECK(inner_error.norm() < 1e-13);
}

TEST_CASE("nothing is done with empty matrices") {
  MatrixXd empty(0, 0);
  CHECK(lapack::cholesky(empty));
  CHECK(lapack::inner(MatrixXd(5, 0), MatrixXd(5, 2)).size() == 0);
}

#if defined(__x86_64__)
TEST_CASE("the kernels are the same on every processor of an architecture") {
#if defined(__aarch64__)
  CHECK(std::string(lapack::kernels()) == "armv8");
#else
  CHECK(std::string(lapack::kernels()) == "Haswell");
#endif
}
#endif

TEST_CASE("the same bytes twice") {
  MatrixXd first = random_covariance(300, 6), second = first;
  REQUIRE(lapack::cholesky(first));
  REQUIRE(lapack::cholesky(second));
  lapack::invert_cholesky(first);
  lapack::invert_cholesky(second);
  CHECK((first.array() == second.array()).all());
}

TEST_CASE("callers in several threads get the same bytes") {
  MatrixXd alone = random_covariance(200, 7);
  std::vector<MatrixXd> together(4, alone);
  REQUIRE(lapack::cholesky(alone));
  lapack::invert_cholesky(alone);
  std::vector<std::thread> threads;
  for (MatrixXd& own : together)
    threads.emplace_back([&own] {
      MatrixXd const before = own;
      for (int repeat = 0; repeat < 20; ++repeat) {
        own = before;
        if (lapack::cholesky(own)) lapack::invert_cholesky(own);
      }
    });
  for (std::thread& one : threads) one.join();
  for (MatrixXd const& own : together) CHECK((own.array() == alone.array()).all());
}
