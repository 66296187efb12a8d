// The polynomials of the input rules, one function per rule: coefficients per interval, in s from 0 to 1.
#pragma once
#include <span>
#include <vector>

namespace sysid {

/// c_0, c_1 of each interval, [N - 1 x 2]: straight lines through samples [N].
std::vector<double> linear_coefficients(std::span<double const> samples);

/// c_0 ... c_3, [N - 1 x 4]: the C2 interpolating cubic spline of samples [N] at time [N], strictly increasing, with not-a-knot
/// ends (de Boor 1978, ch. IV); for N = 2 the line, for N = 3 the parabola.
std::vector<double> cubic_coefficients(std::span<double const> time, std::span<double const> samples);

/// Degree of the polynomials of the band-limited rule.
inline constexpr int band_limited_degree = 7;
/// Samples to either side that shape an interval under the band-limited rule.
inline constexpr int band_limited_reach = 40;

/// c_0 ... c_7, [N - 1 x 8]: sinc interpolation of equally spaced samples [N], N >= 2, with a Kaiser window, sampled on each
/// interval at Chebyshev-Lobatto points.
///
///   x(i + f) = sum_k x_(i+k) w(f - k) sinc(f - k) / sum_k w(f - k) sinc(f - k),   w(u) = I0(beta sqrt(1 - (u/H)^2)) / I0(beta)
///
/// over the 2 H samples nearest to interval i, H = 40, beta = 12 (Kaiser 1974; the denominator keeps constants constant). Ends: odd
/// reflection, x_(-k) = 2 x_0 - x_k. By Kaiser's formulas the stop band is 118 dB down and the transition 0.096 of the sampling
/// rate wide; with the polynomial, a sine of amplitude 1 is met to 1.3e-6 at 0.33 of the sampling rate and to 7e-6 at 0.45, and
/// lost from there to Nyquist.
std::vector<double> band_limited_coefficients(std::span<double const> samples);

}  // namespace sysid
