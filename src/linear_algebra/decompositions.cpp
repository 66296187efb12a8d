// Each function calls one of Eigen's decompositions.
#include "linear_algebra/decompositions.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Householder>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <limits>

#include "core/numeric/elementary.hpp"

namespace sysid {

SymmetricEigen symmetric_eigen(Eigen::MatrixXd const& symmetric) {
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> const solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

SingularValues singular_values(Eigen::MatrixXd const& matrix) {
  Eigen::JacobiSVD<Eigen::MatrixXd> const svd(matrix, Eigen::ComputeThinU | Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixU(), svd.matrixV()};
}

std::optional<Eigen::MatrixXd> cholesky(Eigen::MatrixXd const& symmetric) {
  Eigen::LLT<Eigen::MatrixXd> const factored(symmetric);
  if (factored.info() != Eigen::Success) return std::nullopt;
  return factored.matrixL();
}

Eigen::MatrixXd cholesky_or_diagonal(Eigen::MatrixXd const& symmetric) {
  if (auto factor = cholesky(symmetric)) return *std::move(factor);
  return symmetric.diagonal().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

Eigen::MatrixXd solve_cholesky(Eigen::MatrixXd const& lower, Eigen::MatrixXd const& right) {
  if (right.size() == 0) return right;
  Eigen::MatrixXd const half = lower.triangularView<Eigen::Lower>().solve(right);
  return lower.transpose().triangularView<Eigen::Upper>().solve(half);
}

Eigen::VectorXd solve_symmetric(Eigen::MatrixXd const& symmetric, Eigen::VectorXd const& right) {
  return symmetric.ldlt().solve(right);
}

Eigen::MatrixXd inverse(Eigen::MatrixXd const& square) { return square.partialPivLu().inverse(); }

Eigen::VectorXcd eigenvalues(Eigen::MatrixXd const& square) {
  Eigen::EigenSolver<Eigen::MatrixXd> const solver(square, false);
  return solver.info() == Eigen::Success ? Eigen::VectorXcd(solver.eigenvalues()) : Eigen::VectorXcd();
}

double largest_real_eigenvalue(Eigen::MatrixXd const& square) {
  Eigen::EigenSolver<Eigen::MatrixXd> const solver(square, false);
  return solver.info() == Eigen::Success ? solver.eigenvalues().real().maxCoeff() : std::numeric_limits<double>::quiet_NaN();
}

double log_absolute_determinant(Eigen::MatrixXd const& square) {
  Eigen::PartialPivLU<Eigen::MatrixXd> const factored(square);
  double sum = 0;
  for (double const pivot : factored.matrixLU().diagonal()) sum += elementary::log(std::fabs(pivot));
  return sum;
}

Eigen::MatrixXd solve_upper(Eigen::MatrixXd const& upper, Eigen::MatrixXd const& right) {
  if (right.size() == 0) return right;  // Eigen would take the address of its first number
  return upper.triangularView<Eigen::Upper>().solve(right);
}

OrthogonalTriangular::OrthogonalTriangular(Eigen::MatrixXd const& matrix) {
  Eigen::HouseholderQR<Eigen::MatrixXd> const factored(matrix);
  reflections_ = factored.matrixQR();
  coefficients_ = factored.hCoeffs();
}

Eigen::MatrixXd OrthogonalTriangular::triangle() const {
  return reflections_.topRows(reflections_.cols()).triangularView<Eigen::Upper>();
}

Eigen::MatrixXd OrthogonalTriangular::basis() const {
  return Eigen::householderSequence(reflections_, coefficients_) *
         Eigen::MatrixXd::Identity(reflections_.rows(), reflections_.cols());
}

Eigen::MatrixXd OrthogonalTriangular::turned(Eigen::MatrixXd const& columns) const {
  return Eigen::householderSequence(reflections_, coefficients_).adjoint() * columns;
}

Eigen::MatrixXd OrthogonalTriangular::solve(Eigen::MatrixXd const& right) const {
  return solve_upper(triangle(), turned(right).topRows(reflections_.cols()));
}

}  // namespace sysid
