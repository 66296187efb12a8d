// First and second derivatives of the log likelihood, of several places in one batch.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "likelihood/target.hpp"

namespace sysid {

/// At one place theta [P].
struct LikelihoodSlope {
  Eigen::VectorXd gradient;   // [P]: -J'r
  Eigen::MatrixXd curvature;  // [P x P]: J'J
};
/// Of each column of theta, as Target::gauss_newton has it. steps [P]: of the differences, where there are any.
std::vector<LikelihoodSlope> local_slopes(Target const& target, ConstLanes theta, Eigen::VectorXd const& steps, Ledger& ledger);

}  // namespace sysid
