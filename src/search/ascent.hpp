// Local searches by gradient, for expensive likelihoods that are not sums of squares.
#pragma once
#include <functional>
#include <vector>

#include "search/descent.hpp"

namespace sysid {

/// As `climb` for a target that has a gradient: every climber that is not done by a quasi-Newton method with bounds, of at most
/// `evaluations` each; what has converged is done and has its curvature, by central differences of the gradient.
void climb_by_gradient(Objective const& objective, std::vector<Climber>& climbers, int evaluations, Ledger& ledger,
                       std::function<bool()> const& stop, Journal* journal = nullptr);

}  // namespace sysid
