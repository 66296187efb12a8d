// The last part of a local search: to an optimum that may lie at bounds, and how much there is still to gain.
#pragma once
#include <functional>
#include <vector>

#include "result/mode.hpp"
#include "search/descent.hpp"

namespace sysid {

/// Gain of log density that the next step of a search that has arrived still promises: 0.0045 sd from the optimum.
constexpr double small_gain = 1e-5;
/// That of a search that has not arrived: 0.045 sd.
constexpr double large_gain = 1e-3;

/// As many as a search needs that has come near an optimum, with or without bounds; a curved valley takes more.
constexpr int settling_rounds = 60;

/// Up to `rounds` steps of every climber that its next one promises more than `small_gain`, by Levenberg-Marquardt in the
/// coordinates of `Box`:
///
///   maximise  g's - 1/2 s'(H + damping D) s   over the steps s that stay in the box and move no coordinate by more than two prior
///   widths;   H = J'J + P,  D = diag H
///
/// by the coordinates that are held at an end, released by the sign of their slope (Nocedal and Wright 2006, sec. 16.5). J and g by
/// differences on both sides, inwards at an end. Each round tries five dampings a decade apart. `gain` of a climber is what the
/// undamped step promises at the end. A climber that is left where it was costs the ledger nothing: that was a
/// check. One that is done already is left where it was unless it promises more than `large_gain`. Those of a
/// target that has a gradient are left alone.
void settle(Objective const& objective, std::vector<Climber>& climbers, int rounds, Ledger& ledger,
            std::function<bool()> const& stop, Journal* journal = nullptr);

/// Whether the log density falls by no more than a tenth between two places: they are of one hill, however far apart.
bool connected(Objective const& objective, Mode const& a, Mode const& b);

/// What the next step would be at one place.
struct Outlook {
  double gain = 0;      // that it promises
  double log_mass = 0;  // what its coordinates at bounds add to the mass of the Laplace approximation, which takes the density for
                        // flat there: 1/slope is the mass of one that falls exponentially from its bound
};
/// curvature: what is known of it beforehand; may be empty.
Outlook look_ahead(Objective const& objective, Eigen::VectorXd const& theta, Eigen::MatrixXd const& curvature);

}  // namespace sysid
