// Smoothed signals and their derivatives on equally spaced samples: local polynomials, splines, differences.
#pragma once
#include <span>
#include <vector>

#include "regression/column/spectrum.hpp"

namespace sysid::regression {

/// Weights of samples -half..half for the derivative of given order, at the middle, of the polynomial of degree `degree` fitted to
/// them by least squares (Savitzky and Golay 1964), for a step of 1. derivative <= degree <= 2 half.
std::vector<double> savitzky_golay_weights(int half, int degree, int derivative);

/// Degree of the local polynomial on 2 half + 1 samples for a derivative of a record: the lowest, from derivative + 2, that
/// distorts it by no more than a tenth of its root mean square, distortion being the sum over frequencies clear of the noise of
/// their power times |W(f) - (2 pi i f)^derivative|^2; where none does, the one off least, with the noise that it lets through,
/// noise_sd^2 sum w^2.
int smoother_degree(Spectrum const& record, int half, int derivative, double noise_sd);

/// samples [N] under weights [2 half + 1], divided by `scale`; NaN within half of an end or of a NaN.
std::vector<double> filtered(std::span<double const> samples, std::span<double const> weights, double scale);

/// A penalised spline of degree five with a knot at each sample (Eilers and Marx 1996, with the exact penalty):
///
///   minimise  sum_i (y_i - f(i))^2 + penalty * integral (f''')^2
///
/// over f = sum_j c_j B_j, B_j the cardinal quintic B-spline; the integral is that over the whole support of the basis. Missing
/// samples weigh nothing.
class SmoothingSpline {
 public:
  /// samples: [N], N >= 6, at least three finite; penalty > 0.
  SmoothingSpline(std::span<double const> samples, double penalty);
  /// d^order f at the samples, for a step of 1; order 0..3.
  std::vector<double> derivative(int order) const;

 private:
  int rows_;
  std::vector<double> coefficients_;  // [N + 4]: B-splines centred at -2 .. N + 1
};

/// The penalty at which the mean squared residual is noise_sd^2 (Reinsch 1967), by bisection of its logarithm over 1e-8 .. 1e16.
double penalty_for_noise(std::span<double const> samples, double noise_sd);

}  // namespace sysid::regression
