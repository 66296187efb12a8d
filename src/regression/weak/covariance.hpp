// The covariance of overlapping windows: from the noise of the channels, and from the error of the equation.
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "linear_algebra/band_matrix.hpp"
#include "regression/column/columns.hpp"
#include "regression/weak/integrals.hpp"

namespace sysid::regression {

/// One equation on one record.
struct WeakBlock {
  WeakIntegrals integrals;
  Integrals known;
  std::vector<Integrals> terms;
};

/// Of the rows of one equation at some coefficients w:
///
///   C = sum_c sigma_c^2 G_c(w) G_c(w)^T + own^2 H H^T
///
/// with G_c = d residual / d sample of channel c and H that of the known side. `own` [unit of the known side] is the sd, at a
/// sample, of a white error that no channel accounts for: noise of a recorded input above all. 1e-10 of its mean diagonal is added
/// to the diagonal: what rounding and quadrature leave undecided.
class WeakCovariance {
 public:
  /// noise_sd: of all channels; channels: those that carry noise into the equation.
  WeakCovariance(std::span<WeakBlock const> blocks, std::vector<int> const& channels, std::vector<double> const& noise_sd,
                 Eigen::VectorXd const& coefficients);

  /// Rows, stacked as the blocks are, multiplied by the inverse of the Cholesky factor; those of a block that no sample enters
  /// stay.
  Columns whitened(Columns const& columns, double own) const;
  /// The `own` under which residuals of `columns` at the coefficients of C are most likely, the scale of C free:
  ///
  ///   -n/2 log |L^-1 r|^2 - log det L,   r = known - terms w, L L^T = C
  ///
  /// 0 unless it raises that by log(n)/2, the price of one more number (Schwarz 1978). The coefficients stay what they are: fitted
  /// anew for each `own` they would shrink, as those of noisy regressors do, and all that they then miss would pass for an error.
  double own_noise(Columns const& columns) const;

 private:
  /// rows <- L^-1 rows; returns log det L.
  double whiten(Eigen::Ref<Eigen::MatrixXd> rows, double own_variance) const;

  Eigen::VectorXd coefficients_;
  std::vector<BandMatrix> channels_, equation_;  // per block
};

}  // namespace sysid::regression
