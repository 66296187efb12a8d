// Whether a likelihood has a ridge: walked along, as its curvature at one place says too little of it.
#pragma once
#include <Eigen/Core>

#include "search/objective.hpp"

namespace sysid {

/// Whether the log likelihood stays within 4.5 nats, three sds, of that at theta [P] along `move` [P] or against it. Ridges bend:
/// at the end of the move Gauss-Newton steps across it, which do not go back along it, look for the top.
bool is_ridge(Objective const& objective, Eigen::VectorXd const& theta, Eigen::VectorXd const& move, Ledger& ledger);
/// Whether it does so along `move` and against it, to the ends or to where it has left the straight line by three widths of the
/// prior, as p q = 1 does towards p = 0. Where the objective has a prior, its density must stay as high, too.
bool is_ridge_both_ways(Objective const& objective, Eigen::VectorXd const& theta, Eigen::VectorXd const& move, Ledger& ledger);

}  // namespace sysid
