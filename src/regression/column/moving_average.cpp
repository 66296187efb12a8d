// Gauss-Newton steps, halved until they lower the squares and keep the noise invertible.
#include "regression/column/moving_average.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid::regression {
namespace {

constexpr int most_rounds = 100, most_halvings = 30;
constexpr double enough = 1e-12;  // part of the squares that a round gains
constexpr double moved_out = 0.97;
constexpr double nearly_double = 0.995;  // a zero of C nearer to the circle than this forgets too slowly to be told from it

/// Whether all zeros of C lie outside the unit circle: by the step-down recursion of Levinson, whose numbers are then below 1.
bool is_invertible(std::vector<double> c) {
  for (std::size_t q = c.size(); q > 0; --q) {
    double const reflection = c[q - 1];
    if (!(std::abs(reflection) < nearly_double)) return false;
    std::vector<double> lower(q - 1);
    for (std::size_t k = 0; k + 1 < q; ++k) lower[k] = (c[k] - reflection * c[q - 2 - k]) / (1 - reflection * reflection);
    c = std::move(lower);
  }
  return true;
}

}  // namespace

Eigen::MatrixXd MovingAverage::divided(Eigen::MatrixXd const& v, std::span<Run const> runs) const {
  Eigen::MatrixXd e = v;
  auto const order = static_cast<Eigen::Index>(coefficients.size());
  for (Eigen::Index j = 0; j < v.cols(); ++j)
    for (Run const& run : runs)
      for (Eigen::Index i = 1; i < run.count; ++i)
        for (Eigen::Index k = 1; k <= std::min(order, i); ++k)
          e(run.first + i, j) -= coefficients[static_cast<std::size_t>(k - 1)] * e(run.first + i - k, j);
  return e;
}

Eigen::MatrixXd MovingAverage::slopes(Eigen::VectorXd const& e, std::span<Run const> runs) const {
  Eigen::MatrixXd lagged = Eigen::MatrixXd::Zero(e.size(), static_cast<Eigen::Index>(coefficients.size()));
  for (Eigen::Index k = 1; k <= lagged.cols(); ++k)
    for (Run const& run : runs)
      if (run.count > k) lagged.col(k - 1).segment(run.first + k, run.count - k) = e.segment(run.first, run.count - k);
  return divided(lagged, runs);
}

MovingAverage fitted_moving_average(Eigen::VectorXd const& v, std::span<Run const> runs, MovingAverage from) {
  MovingAverage best = std::move(from);
  int const order = static_cast<int>(best.coefficients.size());
  for (int round = 0; round < most_rounds && !is_invertible(best.coefficients); ++round) {
    double factor = 1;
    for (double& each : best.coefficients) each *= factor *= moved_out;
  }
  Eigen::VectorXd e = best.divided(v, runs);
  double squares = e.squaredNorm();
  for (int round = 0; round < most_rounds && order > 0 && squares > 0; ++round) {
    Eigen::VectorXd const step = OrthogonalTriangular(best.slopes(e, runs)).solve(e);
    double factor = 1, gain = 0;
    for (int halving = 0; halving < most_halvings && gain == 0; ++halving, factor /= 2) {
      MovingAverage next = best;
      for (Eigen::Index k = 0; k < order; ++k) next.coefficients[static_cast<std::size_t>(k)] += factor * step(k);
      if (!is_invertible(next.coefficients)) continue;
      Eigen::VectorXd const left = next.divided(v, runs);
      if (!(left.squaredNorm() < squares)) continue;
      gain = squares - left.squaredNorm();
      best = std::move(next);
      e = left;
      squares -= gain;
    }
    if (gain <= enough * squares) break;
  }
  return best;
}

}  // namespace sysid::regression
