// The maximum of a smooth function in a box.
#pragma once
#include <Eigen/Core>
#include <functional>

namespace sysid::gaussian_process {

/// f at a point, and its gradient [n] where it is asked for; -infinity where there is none.
using Density = std::function<double(Eigen::VectorXd const& at, Eigen::VectorXd& gradient)>;

struct ClimbSettings {
  double scale = 1;         // f is of this size: the first step is long or short by it
  double tolerance = 1e-6;  // it ends when a step gains less
  int most_evaluations = 200;
};

struct Climb {
  Eigen::VectorXd at, gradient;
  double value = 0;  // -infinity when no point was finite
  int evaluations = 0;
  bool converged = false;
};

/// By the limited-memory quasi-Newton method with bounds of NLopt (Luksan's), from a start inside the bounds. Deterministic.
/// Exceptions of f pass through.                                             Nocedal 1980; Liu & Nocedal 1989
Climb maximise(Density const& f, Eigen::VectorXd const& start, Eigen::VectorXd const& lower, Eigen::VectorXd const& upper,
               ClimbSettings const& settings);

}  // namespace sysid::gaussian_process
