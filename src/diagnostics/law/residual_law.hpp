// Whether white residuals are normal noise of constant size: their tails, and whether their size depends on the prediction.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace sysid {

struct ResidualLaw {
  double excess_kurtosis = 0;  // of the residuals about their mean
  double tail_p = 1;           // of such a kurtosis, or a larger one, were they normal
  double growth = 1;           // rms of the third with the largest |prediction| over that of the third with the smallest
  double growth_p = 1;         // of the rank correlation of |residual| and |prediction|, or a larger one, were they independent

  /// limit: of either p. Tails and growth that are too small to matter are no finding, however long the record.
  bool heavy(double limit) const { return tail_p < limit && excess_kurtosis > 1; }
  bool grows(double limit) const { return growth_p < limit && growth > 1.5; }
};

/// Of a sample kurtosis b2 = m4/m2^2, or a larger one, of n normal values, 20 at least: brought to a normal variable by the
/// transformation of Anscombe and Glynn 1983, Biometrika 70, 227.
double kurtosis_p(double b2, double n);

/// residuals: in units of the noise, NaN where there is none; predicted: of the same samples. At least 30 samples, else all p
/// are 1.
///
/// Growth: Spearman's rank correlation of the absolute values, times sqrt(n - 1), one-sided; it holds for any law of the residuals.
/// p is 1 where neighbours are positively correlated by more than 2/sqrt(n).
ResidualLaw residual_law(std::span<double const> residuals, std::span<double const> predicted);

/// The residuals in units of a size that grows with the prediction: its square is a + b predicted^2, as of noise that is in part
/// proportional to the signal, with the mean squares of the thirds with the smallest and the largest |prediction|, and nowhere
/// below that of the first. far: places that are not counted there, which rise.
std::vector<double> in_growing_units(std::span<double const> residuals, std::span<double const> predicted,
                                     std::span<std::size_t const> far);

}  // namespace sysid
