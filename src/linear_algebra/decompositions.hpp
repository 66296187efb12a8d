// Decompositions of dense matrices as plain functions: Eigen's templates for them are the slowest to compile, so it happens once.
#pragma once
#include <Eigen/Core>
#include <optional>

namespace sysid {

/// matrix = vectors * diag(values) * vectors^T, values ascending.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricEigen symmetric_eigen(Eigen::MatrixXd const& symmetric);

/// matrix [n x m] = left * diag(values) * right^T, values descending, min(n, m) of them; right is m x m: columns past the values
/// span what the matrix takes to zero.
struct SingularValues {
  Eigen::VectorXd values;
  Eigen::MatrixXd left;   // n x min(n, m)
  Eigen::MatrixXd right;  // m x m
};
SingularValues singular_values(Eigen::MatrixXd const& matrix);

/// Lower L with L L^T = matrix; nothing where it is not positive definite.
std::optional<Eigen::MatrixXd> cholesky(Eigen::MatrixXd const& symmetric);
/// The same, and where rounding leaves the matrix not positive definite the roots of its diagonal, 0 for what is not above 0.
Eigen::MatrixXd cholesky_or_diagonal(Eigen::MatrixXd const& symmetric);
/// x of L L^T x = right.
Eigen::MatrixXd solve_cholesky(Eigen::MatrixXd const& lower, Eigen::MatrixXd const& right);

/// x of matrix * x = right, matrix symmetric and positive or negative semidefinite (L D L^T with pivots).
Eigen::VectorXd solve_symmetric(Eigen::MatrixXd const& symmetric, Eigen::VectorXd const& right);

Eigen::MatrixXd inverse(Eigen::MatrixXd const& square);

/// In no order; none where the iteration does not converge.
Eigen::VectorXcd eigenvalues(Eigen::MatrixXd const& square);
/// The largest real part of an eigenvalue, to about 1e-15 of the largest entry; NaN where the iteration does not converge.
double largest_real_eigenvalue(Eigen::MatrixXd const& square);

/// log |det|, as a sum: the product may leave the range of numbers.
double log_absolute_determinant(Eigen::MatrixXd const& square);

/// Upper triangular solve: x of upper * x = right, which may have no columns.
Eigen::MatrixXd solve_upper(Eigen::MatrixXd const& upper, Eigen::MatrixXd const& right);

/// matrix [n x m], n >= m, as Q R by Householder reflections.
class OrthogonalTriangular {
 public:
  explicit OrthogonalTriangular(Eigen::MatrixXd const& matrix);
  /// R [m x m], zeros below the diagonal.
  Eigen::MatrixXd triangle() const;
  /// First m columns of Q.
  Eigen::MatrixXd basis() const;
  /// Q^T * columns, all n rows.
  Eigen::MatrixXd turned(Eigen::MatrixXd const& columns) const;
  /// x of least |matrix * x - right|.
  Eigen::MatrixXd solve(Eigen::MatrixXd const& right) const;

 private:
  Eigen::MatrixXd reflections_;  // as Eigen packs them
  Eigen::VectorXd coefficients_;
};

}  // namespace sysid
