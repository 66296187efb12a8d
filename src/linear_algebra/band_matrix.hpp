// Symmetric positive definite matrices with a narrow band: covariances of overlapping windows, normal equations of splines.
#pragma once
#include <Eigen/Core>

namespace sysid::regression {

/// The lower triangle of [N x N] with `band` diagonals below the main one.
class BandMatrix {
 public:
  BandMatrix(int size, int band) : band_(band), entries_(Eigen::MatrixXd::Zero(band + 1, size)) {}

  int size() const { return static_cast<int>(entries_.cols()); }
  int band() const { return band_; }
  /// row >= column, row - column <= band.
  double& operator()(int row, int column) { return entries_(row - column, column); }
  double operator()(int row, int column) const { return entries_(row - column, column); }

  /// A += factor * other, of the same size and band.
  void add(double factor, BandMatrix const& other) { entries_ += factor * other.entries_; }

  /// Replaces A by its Cholesky factor L, A = L L^T; false (and a spoilt matrix) when A is not positive definite.
  bool factor();
  /// L^-1 b in place, for each column; of a factored matrix.
  void solve_lower(Eigen::Ref<Eigen::MatrixXd> b) const;
  /// L^-T b in place.
  void solve_upper(Eigen::Ref<Eigen::MatrixXd> b) const;

 private:
  int band_;
  Eigen::MatrixXd entries_;
};

}  // namespace sysid::regression
