// The highest point of a quadratic in a box.
#pragma once
#include <Eigen/Core>

namespace sysid {

/// The step s [P] with the largest g's - 1/2 s'Hs for low <= s <= high, which hold 0: by the coordinates that are held at an end.
/// Each turn rises. h [P x P] positive definite (Nocedal and Wright 2006, sec. 16.5).
Eigen::VectorXd best_step(Eigen::MatrixXd const& h, Eigen::VectorXd const& g, Eigen::VectorXd const& low,
                          Eigen::VectorXd const& high);

}  // namespace sysid
