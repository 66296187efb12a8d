// Levenberg-Marquardt from many starts at once: every finite difference and every trial step of every start is a lane of one batch.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <vector>

#include "core/numeric/not_finite.hpp"
#include "search/objective.hpp"

namespace sysid {

class Journal;

/// One local search.
struct Climber {
  Eigen::VectorXd theta;
  double log_density = 0;
  double damping = 1e-2;
  Eigen::MatrixXd curvature;  // Gauss-Newton plus the prior's, at the point before the last step; empty before the first
  bool done = false;          // no further step is worth taking, or none is possible
  int hits = 1;               // searches that it stands for
  double gain = infinity;     // of the log density that its next step promises, as far as bounds leave room; infinite: not asked
  bool stalled = false;       // no step that was tried gained anything, whatever was promised
};

/// Blocks hold a few million residuals at most, whatever the length of the record.
std::size_t climbers_per_block(Objective const& objective);

Climber climber_at(Eigen::VectorXd theta, double log_density);

/// Of the log density at a place.
struct Slope {
  Eigen::VectorXd gradient;   // [P]
  Eigen::MatrixXd curvature;  // of Gauss and Newton, with the prior's: J'J + P as below
};
Slope slope_at(Objective const& objective, Eigen::VectorXd const& theta, Ledger& ledger);
/// Of several places in one batch, each as if alone.
std::vector<Slope> slopes_at(Objective const& objective, std::vector<Eigen::VectorXd> const& places, Ledger& ledger);

/// Up to `rounds` steps of every climber that is not done; stops early when `stop` says so. A `journal` keeps it, as a step of
/// its own; none costs nothing.
///
///   maximise  -1/2 sum r(theta)^2 + log prior(theta);   (J'J + P + damping D) step = -J'r + grad log prior,   D = diag(J'J + P)
///
/// J is the target's; where it takes differences, over 1e-5 prior widths, more where it is rough. P is minus the diagonal second
/// derivative of the log prior where positive. Each round tries four dampings a decade apart and keeps the best. Steps are at most
/// two prior widths long in any coordinate. An expensive target is climbed by its gradient instead. Levenberg 1944, Marquardt 1963;
/// as in More 1978 but for the choice of damping, which lanes make cheap.
void climb(Objective const& objective, std::vector<Climber>& climbers, int rounds, Ledger& ledger,
           std::function<bool()> const& stop, Journal* journal = nullptr);

}  // namespace sysid
