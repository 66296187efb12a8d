// Errors of recorded inputs: they move the states, and so the errors of the samples that follow depend on each other.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <vector>

namespace sysid {

/// Of one record with N rows, d states and u inputs:
///
///   x(n+1) = ahead(n) x(n) + here(n) e(n) + next(n) e(n+1),   sample of channel c = x(state of c) + its own error
///
/// x the move of the states away from the right motion, e the independent errors of the inputs.
struct CarriedErrors {
  std::vector<Eigen::MatrixXd> ahead, here, next;  // [N - 1]
  std::vector<Eigen::VectorXd> input_sd;           // [N], [u]
  std::vector<int> state_of_channel;               // -1: no input moves it
  std::vector<std::vector<double>> own_sd;         // [channels][N]
};

/// Makes the errors of the rows of a segment independent: each row is replaced by its difference from what the rows before it
/// foretell (Kalman filter; the start of the segment is known exactly, since fits have it as an unknown of its own).
class RowWhitener {
 public:
  /// Rows first to first + count; in slopes they are channel by channel. measured: by row of slopes.
  RowWhitener(CarriedErrors const& errors, int first, int count, std::function<bool(int)> const& measured);

  /// sd of what a row has anew; 1 where nothing is measured.
  std::vector<double> const& sds() const { return sds_; }
  /// In place, by columns; not divided by the sds.
  void apply(Eigen::Ref<Eigen::MatrixXd> columns) const;

 private:
  int count_;
  Eigen::Index size_ = 0;  // states and inputs
  std::vector<int> state_of_channel_;
  std::vector<double> sds_;                // per row of slopes
  std::vector<Eigen::VectorXd> gains_;     // the same; empty: nothing measured, or not carried
  std::vector<Eigen::MatrixXd> forwards_;  // [count - 1]
};

}  // namespace sysid
