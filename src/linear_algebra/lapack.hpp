// Dense linear algebra of matrices with thousands of rows: the BLAS and LAPACK routines of OpenBLAS that we use, and in one place
// how the library is loaded.
//
// It is loaded when the first routine is called, so that whoever needs none does not pay for it. It runs in the caller's thread
// alone, and with one set of kernels, which every processor has that this program runs on: those for AVX2 and FMA, on AArch64 those
// of ARMv8. Left to itself this OpenBLAS takes processors that are younger than it is for those of 2004, and its results would
// depend on the processor.
#pragma once
#include <Eigen/Core>

namespace sysid::lapack {

/// Lower Cholesky factor in place; only the lower triangle is read and written. False, and a spoilt matrix, when it is not positive
/// definite. Throws UserError (as everything here) when OpenBLAS cannot be loaded.                                        dpotrf
bool cholesky(Eigen::Ref<Eigen::MatrixXd> symmetric);

/// The lower triangle of (L L^T)^-1 in place of L.                                                                        dpotri
void invert_cholesky(Eigen::Ref<Eigen::MatrixXd> lower);

/// L^-1 right and L^-T right in place.                                                                                    dtrsm
void solve_lower(Eigen::Ref<Eigen::MatrixXd const> lower, Eigen::Ref<Eigen::MatrixXd> right);
void solve_lower_transposed(Eigen::Ref<Eigen::MatrixXd const> lower, Eigen::Ref<Eigen::MatrixXd> right);

/// Lower triangle of symmetric += factor * columns * columns^T.                                                           dsyrk
void add_outer(double factor, Eigen::Ref<Eigen::MatrixXd const> columns, Eigen::Ref<Eigen::MatrixXd> symmetric);
/// Lower triangle of symmetric += factor * rows^T * rows.
void add_inner(double factor, Eigen::Ref<Eigen::MatrixXd const> rows, Eigen::Ref<Eigen::MatrixXd> symmetric);

/// left^T * right.                                                                                                        dgemm
Eigen::MatrixXd inner(Eigen::Ref<Eigen::MatrixXd const> left, Eigen::Ref<Eigen::MatrixXd const> right);

/// Which of OpenBLAS's kernels are in force, as it calls them.
char const* kernels();

}  // namespace sysid::lapack
