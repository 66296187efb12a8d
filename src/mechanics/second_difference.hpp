// Derivatives of measured samples that are equally far apart.
#pragma once
#include <vector>

namespace sysid {

/// The second derivative of equidistant samples at sample i, by the parabola of least squares through 2 half_width + 1 of them, as
/// weights:
///
///   D y_i = sum_k w_k y_(i+k) / step^2 = sum_k s_k (y_(i+k+1) - 2 y_(i+k) + y_(i+k-1)) / step^2
///
/// w: [2 half_width + 1]; s: [2 half_width - 1], their sum is 1: what the derivative is smoothed by. half_width >= 2.
struct SecondDifference {
  explicit SecondDifference(int half_width);
  std::vector<double> weights, smoothing;
  /// sd of D y_i for independent noise of sd 1 on the samples and a step of 1.
  double noise = 0;
};

/// A signal with its derivatives, each [N - 2 half_width]: of sample half_width first. The value is that of the parabola above, the
/// velocity the slope of a cubic: a parabola's slope is that of a line, which is too flat wherever the curvature is still right.
struct Derivatives {
  std::vector<double> value, velocity, acceleration;
};
Derivatives derivatives(std::vector<double> const& samples, int half_width, double step);

/// Whether samples are as far apart as the first two, to a millionth.
bool equidistant(std::vector<double> const& time);

}  // namespace sysid
