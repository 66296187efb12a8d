// How predictions answer to parameters at one point: slopes by central differences over a ladder of steps, each with the error that
// the ladder itself shows.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <span>

#include "core/numeric/lanes.hpp"

namespace sysid {

/// Outputs [R x W] of points [N x W], in units of their noise; NaN throughout where there are none.
using OutputFunction = std::function<void(ConstLanes points, Lanes out)>;

/// Slopes at one point, reduced: only lengths and angles of their columns matter, and a triangular factor keeps those.
struct Sensitivity {
  bool finite = false;        // false: an output near the point is not
  Eigen::MatrixXd slopes;     // [P x P], upper triangular: Q^T times d out / d (parameter / scale), nuisances projected out
  Eigen::VectorXd error;      // [P] length of the estimated error of each column before projection
  double nuisance_error = 0;  // relative, of the columns projected out
  double size = 0;            // length of the outputs
  Eigen::MatrixXd others;     // [P x K] the same Q^T times K given vectors: what of them looks like a change of the parameters
};

/// Slopes with respect to the first `parameters` rows of `point` [N], in steps relative to `scale` [N]; the other rows are
/// nuisances, whose slopes are projected out: what is left is what the outputs tell about the parameters when the nuisances are
/// free.
///
///   D(h) = (f(x + h s) - f(x - h s)) / 2 h,   h = 1e-2 4^-i, i = 0 ... 7                 after Ridders 1982
///
/// Of neighbouring steps the pair with the least |D(h) - D(4 h)| gives the slope (16 D(h) - D(4 h)) / 15; that difference, far
/// above the error of the combination, stands as its error: truncation, rounding and kinks all show in it. others: K further
/// vectors [R x K], in the units of the outputs.
Sensitivity sensitivity(OutputFunction const& outputs, int rows, std::span<double const> point, std::span<double const> scale,
                        int parameters, Eigen::MatrixXd const& others = {});

}  // namespace sysid
