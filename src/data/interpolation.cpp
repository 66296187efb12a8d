// Piecewise polynomials from samples. Order of operations is fixed: inputs enter results that are promised bit for bit.
#include "data/interpolation.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "core/numeric/elementary.hpp"

namespace sysid {
namespace {

/// Second derivatives [N] of the not-a-knot spline; N >= 2.
std::vector<double> second_derivatives(std::span<double const> time, std::span<double const> samples) {
  std::size_t const n = samples.size();
  std::vector<double> m(n, 0.0);
  if (n == 2) return m;
  auto const step = [&](std::size_t i) { return time[i + 1] - time[i]; };
  auto const slope = [&](std::size_t i) { return (samples[i + 1] - samples[i]) / step(i); };
  if (n == 3) {
    m.assign(3, 2 * (slope(1) - slope(0)) / (step(0) + step(1)));
    return m;
  }
  // h_(i-1) m_(i-1) + 2 (h_(i-1) + h_i) m_i + h_i m_(i+1) = 6 (slope_i - slope_(i-1)) for i = 1 ... n - 2, where equal third
  // derivatives on the two outermost intervals give m_0 = m_1 + r (m_1 - m_2), r = h_0 / h_1, and likewise at the other end.
  // Thomas' algorithm: the rows stay diagonally dominant.
  std::vector<double> upper(n, 0.0);
  double const first_ratio = step(0) / step(1);
  double const last_ratio = step(n - 2) / step(n - 3);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    double lower = step(i - 1), diagonal = 2 * (step(i - 1) + step(i)), above = step(i);
    if (i == 1) {
      diagonal += lower * (1 + first_ratio);
      above -= lower * first_ratio;
      lower = 0;
    }
    if (i + 2 == n) {
      diagonal += step(i) * (1 + last_ratio);
      lower -= step(i) * last_ratio;
      above = 0;
    }
    double const pivot = diagonal - lower * upper[i - 1];
    upper[i] = above / pivot;
    m[i] = (6 * (slope(i) - slope(i - 1)) - lower * m[i - 1]) / pivot;
  }
  for (std::size_t i = n - 2; i-- > 1;) m[i] -= upper[i] * m[i + 1];
  m[0] = m[1] + first_ratio * (m[1] - m[2]);
  m[n - 1] = m[n - 2] + last_ratio * (m[n - 2] - m[n - 3]);
  return m;
}

/// Modified Bessel function of order 0 by its power series, sum ((x/2)^j / j!)^2: all terms positive.
double bessel_i0(double x) {
  double sum = 1, term = 1;
  for (int j = 1; term > 1e-17 * sum; ++j) {
    double const factor = x / (2 * j);
    term *= factor * factor;
    sum += term;
  }
  return sum;
}

constexpr int inner = band_limited_degree - 1;  // Chebyshev-Lobatto points between the two samples
constexpr int taps = 2 * band_limited_reach;
constexpr double beta = 12;

/// What turns samples into polynomials; the same for every interval.
struct BandLimitedKernel {
  std::array<double, inner> node;                      // s of each inner point
  std::array<std::array<double, inner>, taps> weight;  // of sample i + 1 - reach + tap
  std::array<std::array<double, band_limited_degree + 1>, inner>
      monomial;  // Lagrange polynomial of each inner point, in powers of s
};

BandLimitedKernel make_kernel() {
  BandLimitedKernel kernel;
  double const pi = std::numbers::pi;
  std::array<double, inner + 2> points;
  for (int j = 0; j < inner + 2; ++j) points[static_cast<std::size_t>(j)] = (1 - elementary::cos(pi * j / (inner + 1))) / 2;
  points.front() = 0;
  points.back() = 1;
  for (std::size_t j = 0; j < inner; ++j) {
    double const f = kernel.node[j] = points[j + 1];
    double const sine = elementary::sin(pi * f);
    double sum = 0;
    for (std::size_t tap = 0; tap < taps; ++tap) {
      int const k = static_cast<int>(tap) + 1 - band_limited_reach;
      double const distance = f - k;
      double const ratio = distance / band_limited_reach;
      double const window = bessel_i0(beta * std::sqrt(1 - ratio * ratio)) / bessel_i0(beta);
      // sin(pi (f - k)) = (-1)^k sin(pi f)
      kernel.weight[tap][j] = (k % 2 == 0 ? sine : -sine) / (pi * distance) * window;
      sum += kernel.weight[tap][j];
    }
    for (std::size_t tap = 0; tap < taps; ++tap) kernel.weight[tap][j] /= sum;

    auto& polynomial = kernel.monomial[j];
    polynomial = {1};
    std::size_t degree = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (i == j + 1) continue;
      double const scale = 1 / (f - points[i]);
      ++degree;
      for (std::size_t p = degree; p > 0; --p) polynomial[p] = (polynomial[p - 1] - points[i] * polynomial[p]) * scale;
      polynomial[0] *= -points[i] * scale;
    }
  }
  return kernel;
}

/// The samples with `band_limited_reach` more at each end, by odd reflection.
std::vector<double> reflected(std::span<double const> samples) {
  auto const last = static_cast<std::ptrdiff_t>(samples.size()) - 1;
  auto const n = static_cast<std::ptrdiff_t>(samples.size());
  std::vector<double> extended(samples.size() + 2 * band_limited_reach);
  for (std::ptrdiff_t i = -band_limited_reach; i < n + band_limited_reach; ++i) {
    // A short record is reflected more than once.
    double constant = 0, sign = 1;
    std::ptrdiff_t at = i;
    while (at < 0 || at > last) {
      constant += sign * 2 * (at < 0 ? samples.front() : samples.back());
      sign = -sign;
      at = at < 0 ? -at : 2 * last - at;
    }
    extended[static_cast<std::size_t>(i + band_limited_reach)] = constant + sign * samples[static_cast<std::size_t>(at)];
  }
  return extended;
}

}  // namespace

std::vector<double> linear_coefficients(std::span<double const> samples) {
  std::vector<double> coefficients;
  coefficients.reserve(2 * (samples.size() - 1));
  for (std::size_t i = 0; i + 1 < samples.size(); ++i)
    coefficients.insert(coefficients.end(), {samples[i], samples[i + 1] - samples[i]});
  return coefficients;
}

std::vector<double> cubic_coefficients(std::span<double const> time, std::span<double const> samples) {
  std::vector<double> const m = second_derivatives(time, samples);
  std::vector<double> coefficients;
  coefficients.reserve(4 * (samples.size() - 1));
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    double const h = time[i + 1] - time[i], h2 = h * h;
    coefficients.insert(coefficients.end(), {samples[i], samples[i + 1] - samples[i] - h2 * (2 * m[i] + m[i + 1]) / 6,
                                             h2 * m[i] / 2, h2 * (m[i + 1] - m[i]) / 6});
  }
  return coefficients;
}

std::vector<double> band_limited_coefficients(std::span<double const> samples) {
  BandLimitedKernel const kernel = make_kernel();
  std::vector<double> const extended = reflected(samples);
  std::vector<double> coefficients;
  coefficients.reserve((band_limited_degree + 1) * (samples.size() - 1));
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    // Relative to the line through both samples, which the polynomial then meets exactly.
    double const start = samples[i], rise = samples[i + 1] - samples[i];
    double const* const nearby = extended.data() + i + 1;
    std::array<double, inner> at_node{};
    for (std::size_t tap = 0; tap < taps; ++tap)
      for (std::size_t j = 0; j < inner; ++j) at_node[j] += kernel.weight[tap][j] * nearby[tap];
    std::array<double, band_limited_degree + 1> c{start, rise};
    for (std::size_t j = 0; j < inner; ++j) {
      double const excess = at_node[j] - (start + kernel.node[j] * rise);
      for (std::size_t p = 1; p < c.size(); ++p) c[p] += excess * kernel.monomial[j][p];
    }
    coefficients.insert(coefficients.end(), c.begin(), c.end());
  }
  return coefficients;
}

}  // namespace sysid
