// Local searches that need no widths of a prior: steps are measured by the curvature alone.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <vector>

#include "search/descent.hpp"
#include "search/objective.hpp"

namespace sysid::unbounded {

/// One of them; `held` names a coordinate that stays as it is, -1 none.
struct FreeClimber {
  Eigen::VectorXd theta;
  double log_density = 0;
  int held = -1;
  double damping = 1e-2;
  Eigen::MatrixXd curvature = {};  // of Gauss and Newton, at the point before the last step; empty before the first
  bool done = false;               // no further step is worth taking, or none gained anything
};

/// Slopes of the log density at each place. Where derivatives are differences, each place has its own steps: a part of the value of
/// a coordinate on a line, whatever its unit.
std::vector<Slope> free_slopes(Objective const& objective, std::vector<Eigen::VectorXd> const& places, Ledger& ledger);

/// Up to `rounds` Levenberg-Marquardt steps of each, five dampings at once:
///
///   (C + damping I) D^1/2 step = D^-1/2 gradient,   C = D^-1/2 H D^-1/2,   D = diag(H)
///
/// Coordinates without curvature stay. A step moves a logarithm by 4.6, a factor of 100, at most.          More 1978
void climb_freely(Objective const& objective, std::vector<FreeClimber>& climbers, int rounds, Ledger& ledger,
                  std::function<bool()> const& stop);

}  // namespace sysid::unbounded
