// One batch of sixteen lanes per parameter; columns are kept only until their triangular factor is computed.
#include "diagnostics/identifiability/sensitivity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "linear_algebra/decompositions.hpp"

namespace sysid {
namespace {

constexpr int levels = 8;

}  // namespace

Sensitivity sensitivity(OutputFunction const& outputs, int rows, std::span<double const> point, std::span<double const> scale,
                        int parameters, Eigen::MatrixXd const& others) {
  int const all = static_cast<int>(point.size());
  Sensitivity result;
  LaneArray here(all, 1), base(rows, 1), points(all, 2 * levels), values(rows, 2 * levels);
  for (int r = 0; r < all; ++r) here(r, 0) = point[static_cast<std::size_t>(r)];
  outputs(here, base);
  for (int i = 0; i < rows; ++i) result.size += base(i, 0) * base(i, 0);
  result.size = std::sqrt(result.size);
  if (!std::isfinite(result.size)) return result;

  Eigen::MatrixXd columns(rows, all);
  Eigen::VectorXd errors(all);
  for (int p = 0; p < all; ++p) {
    for (int r = 0; r < all; ++r)
      for (int w = 0; w < 2 * levels; ++w) points(r, w) = here(r, 0);
    std::vector<double> step(levels);
    double h = 1e-2;
    for (int i = 0; i < levels; ++i, h /= 4) {
      double const up = here(p, 0) + h * scale[static_cast<std::size_t>(p)],
                   down = here(p, 0) - h * scale[static_cast<std::size_t>(p)];
      points(p, 2 * i) = up;
      points(p, 2 * i + 1) = down;
      step[static_cast<std::size_t>(i)] = (up - down) / scale[static_cast<std::size_t>(p)];  // as rounded
    }
    outputs(points, values);
    Eigen::VectorXd coarse, best;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < levels; ++i) {
      Eigen::VectorXd fine(rows);
      for (int k = 0; k < rows; ++k) fine(k) = (values(k, 2 * i) - values(k, 2 * i + 1)) / step[static_cast<std::size_t>(i)];
      if (i > 0) {
        double const error = (fine - coarse).norm();  // NaN where an outer step left the region that can be simulated
        if (error < least) {
          least = error;
          best = (16 * fine - coarse) / 15;
        }
      }
      coarse = std::move(fine);
    }
    if (!std::isfinite(least)) return result;
    columns.col(p) = best;
    errors(p) = least;
  }
  result.finite = true;
  result.error = errors.head(parameters);

  // Nuisances first: what is left below their rows of the triangle is orthogonal to them.
  Eigen::MatrixXd stacked(rows, all);
  int nuisances = 0;
  double square = 0;
  for (int p = parameters; p < all; ++p) {
    double const length = columns.col(p).norm();
    if (!(length > 10 * errors(p))) continue;
    stacked.col(nuisances++) = columns.col(p) / length;
    square += (errors(p) / length) * (errors(p) / length);
  }
  result.nuisance_error = std::sqrt(square);
  stacked.middleCols(nuisances, parameters) = columns.leftCols(parameters);
  int const width = nuisances + parameters, extra = static_cast<int>(others.cols());
  // Rows of zeros below, so that fewer outputs than parameters are no special case.
  Eigen::MatrixXd tall = Eigen::MatrixXd::Zero(std::max(rows, width), width);
  tall.topRows(rows) = stacked.leftCols(width);
  OrthogonalTriangular const factored(tall);
  result.slopes = factored.triangle().bottomRightCorner(parameters, parameters);
  if (extra > 0) {
    Eigen::MatrixXd given = Eigen::MatrixXd::Zero(tall.rows(), extra);
    given.topRows(rows) = others;
    result.others = factored.turned(given).middleRows(nuisances, parameters);
  }
  return result;
}

}  // namespace sysid
