// Derivatives of segments by differences, with perturbations large enough to exceed rounding.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "likelihood/segments/segments.hpp"

namespace sysid {

/// How often the perturbations of a first point may be mended: each may be wrong by many powers of ten.
inline constexpr int most_probes = 12;

/// What each unknown is perturbed by, in its own unit.
struct Perturbations {
  Eigen::VectorXd coefficient;  // [k]
  Eigen::MatrixXd start;        // [states x segments]
};

/// The simulation at points one after the other. What the differences at one say serves the next: each perturbation moves the
/// outputs by about 1e-6 of their sd, 1e-4 with adaptive solvers.
class SegmentDifferences {
 public:
  /// at: first perturbations are in proportion to its unknowns. The simulation has to outlive this.
  SegmentDifferences(SegmentSimulation const& simulation, ShootingPoint const& at);

  /// Residuals, and slopes per unit of each unknown. probes: how often perturbations that do not show may be mended. Residuals that
  /// are not finite stay so.
  std::vector<SegmentSlopes> at(ShootingPoint const& point, int probes);

 private:
  /// The next perturbations, after slopes that are not divided yet. Whether those just used would serve again.
  bool mend(std::vector<SegmentSlopes> const& slopes);
  void divide(std::vector<SegmentSlopes>& slopes) const;

  SegmentSimulation const& simulation_;
  Perturbations next_, used_;
};

}  // namespace sysid
