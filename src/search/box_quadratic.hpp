// The log density near places of a box as a quadratic, by differences that stay inside.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "search/box.hpp"
#include "search/objective.hpp"

namespace sysid {

/// The log density near a place: gradient and Gauss-Newton curvature in z. Not finite where the place has no neighbours.
struct Quadratic {
  Eigen::VectorXd gradient;
  Eigen::MatrixXd curvature;
};

/// places: in z [P] each. curvatures: what is known of them beforehand [P x P], empty where nothing is; for a rough target they
/// give the axes along which differences are taken.
std::vector<Quadratic> quadratics_at(Objective const& objective, Box const& box, std::vector<Eigen::VectorXd> const& places,
                                     std::vector<Eigen::MatrixXd> const& curvatures, Ledger& ledger);

}  // namespace sysid
