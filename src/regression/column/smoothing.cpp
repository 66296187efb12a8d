// Filters by least squares on polynomials and B-splines.
#include "regression/column/smoothing.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/numeric/elementary.hpp"
#include "linear_algebra/band_matrix.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid::regression {
namespace {

constexpr int most_degrees = 13;           // above the derivative
constexpr double clear_of_noise = 8;       // a frequency without motion is above it by chance once in three thousand
constexpr double distorted_at_most = 0.1;  // of the root mean square of a derivative
constexpr int reach = 2;                   // a quintic B-spline is zero at integers three and more from its middle

/// Derivatives of the cardinal quintic B-spline at -2..2.
constexpr double b_spline[4][5] = {{1.0 / 120, 26.0 / 120, 66.0 / 120, 26.0 / 120, 1.0 / 120},
                                   {1.0 / 24, 10.0 / 24, 0, -10.0 / 24, -1.0 / 24},
                                   {1.0 / 6, 2.0 / 6, -1, 2.0 / 6, 1.0 / 6},
                                   {1.0 / 2, -1, 0, 1, -1.0 / 2}};

double squared_residual(std::span<double const> samples, std::vector<double> const& smooth) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (std::isfinite(samples[i])) sum += (samples[i] - smooth[i]) * (samples[i] - smooth[i]), ++count;
  return sum / count;
}

}  // namespace

std::vector<double> savitzky_golay_weights(int half, int degree, int derivative) {
  int const count = 2 * half + 1;
  Eigen::MatrixXd powers(count, degree + 1);  // of t / half, to stay well conditioned
  for (int i = 0; i < count; ++i) {
    double const t = static_cast<double>(i - half) / std::max(half, 1);
    double power = 1;
    for (int k = 0; k <= degree; ++k, power *= t) powers(i, k) = power;
  }
  Eigen::MatrixXd const inverse = OrthogonalTriangular(powers).solve(Eigen::MatrixXd::Identity(count, count));
  double factor = 1;  // derivative! / half^derivative
  for (int k = 1; k <= derivative; ++k) factor *= static_cast<double>(k) / std::max(half, 1);
  std::vector<double> weights;
  for (int i = 0; i < count; ++i) weights.push_back(factor * inverse(derivative, i));
  return weights;
}

int smoother_degree(Spectrum const& record, int half, int derivative, double noise_sd) {
  double const noise_share = 2 * noise_sd * noise_sd / static_cast<double>(std::max<std::size_t>(record.size, 1));
  int best = derivative + 2;
  double least = std::numeric_limits<double>::infinity();
  // A degree of the derivative's own parity adds nothing at the middle of a symmetric window.
  for (int degree = derivative + 2; degree < 2 * half && degree <= derivative + most_degrees; degree += 2) {
    std::vector<double> const weights = savitzky_golay_weights(half, degree, derivative);
    double noise = 0, off = 0, motion = 0;
    for (double const weight : weights) noise += noise_sd * noise_sd * weight * weight;
    for (std::size_t k = 1; k < record.power.size(); ++k) {
      double const power = record.power[k] - noise_share;
      if (power < clear_of_noise * noise_share) continue;
      double const angle = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(record.size);
      // Even derivatives: real parts; odd ones: imaginary parts, i left out.
      double gain = derivative % 2 == 0 ? weights[static_cast<std::size_t>(half)] : 0, ideal = 1;
      for (int j = 1; j <= half; ++j)
        gain += 2 * weights[static_cast<std::size_t>(half + j)] *
                (derivative % 2 == 0 ? elementary::cos(angle * j) : elementary::sin(angle * j));
      for (int d = 0; d < derivative; ++d) ideal *= angle;
      if (derivative % 4 >= 2) ideal = -ideal;
      off += power * (gain - ideal) * (gain - ideal);
      motion += power * ideal * ideal;
    }
    if (off <= distorted_at_most * distorted_at_most * motion) return degree;
    if (!(off + noise < least)) continue;
    best = degree;
    least = off + noise;
  }
  return best;
}

std::vector<double> filtered(std::span<double const> samples, std::span<double const> weights, double scale) {
  std::size_t const half = weights.size() / 2;
  std::vector<double> out(samples.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = half; i + half < samples.size(); ++i) {
    double sum = 0;
    for (std::size_t k = 0; k < weights.size(); ++k) sum += weights[k] * samples[i - half + k];
    out[i] = sum / scale;
  }
  return out;
}

SmoothingSpline::SmoothingSpline(std::span<double const> samples, double penalty) : rows_(static_cast<int>(samples.size())) {
  int const size = rows_ + 2 * reach;
  BandMatrix normal(size, 5);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
  for (int i = 0; i < rows_; ++i) {
    double const sample = samples[static_cast<std::size_t>(i)];
    if (!std::isfinite(sample)) continue;
    for (int a = 0; a <= 2 * reach; ++a) {
      right(i + a) += b_spline[0][a] * sample;
      for (int b = 0; b <= a; ++b) normal(i + a, i + b) += b_spline[0][a] * b_spline[0][b];
    }
  }
  // f''' = sum_j (third difference of c)_j (quadratic B-spline)_j, whose inner products are the quintic's values at integers.
  constexpr double difference[] = {-1, 3, -3, 1};
  for (int shift = -reach; shift <= reach; ++shift)
    for (int j = 0; j + 3 < size; ++j) {
      int const other = j + shift;
      if (other < 0 || other + 3 >= size) continue;
      for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b) {
          int const row = j + a, column = other + b;
          if (row >= column) normal(row, column) += penalty * b_spline[0][shift + reach] * difference[a] * difference[b];
        }
    }
  normal.factor();
  Eigen::MatrixXd solution = right;
  normal.solve_lower(solution);
  normal.solve_upper(solution);
  coefficients_.assign(solution.data(), solution.data() + size);
}

std::vector<double> SmoothingSpline::derivative(int order) const {
  std::vector<double> out;
  for (int i = 0; i < rows_; ++i) {
    double sum = 0;
    // B_j is centred at j, so the sample i lies at i - j from it: weights run backwards.
    for (int a = 0; a <= 2 * reach; ++a) sum += b_spline[order][2 * reach - a] * coefficients_[static_cast<std::size_t>(i + a)];
    out.push_back(sum);
  }
  return out;
}

double penalty_for_noise(std::span<double const> samples, double noise_sd) {
  double low = elementary::log(1e-8), high = elementary::log(1e16);
  for (int step = 0; step < 40; ++step) {
    double const middle = (low + high) / 2;
    SmoothingSpline const spline(samples, elementary::exp(middle));
    (squared_residual(samples, spline.derivative(0)) < noise_sd * noise_sd ? low : high) = middle;
  }
  return elementary::exp((low + high) / 2);
}

}  // namespace sysid::regression
