// Coordinates in which a bound is the end of an interval: what a search climbs in near one. The sampler's go to infinity there, and
// every density becomes flat in them, whether it still rises towards the bound or not.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "search/objective.hpp"

namespace sysid {

/// z(theta), coordinate by coordinate and rising:
///
///   both bounds finite   z = 1/(1 + exp(-theta)), the share of the interval; of its logarithm where the coordinate is one of that
///   one bound            z = log(1 + exp(theta - m)), m the prior's median: the distance from the bound where that is small, its
///                        logarithm where it is large
///   none                 z = theta
///
/// An end is 1e-12 away from its bound in z. For the density on the sampler's coordinates, which vanishes at bounds, z = theta
/// throughout.
class Box {
 public:
  explicit Box(Objective const& objective);

  Eigen::VectorXd inside(Eigen::VectorXd const& theta) const;
  Eigen::VectorXd outside(Eigen::VectorXd const& z) const;
  /// dz/dtheta.
  Eigen::VectorXd slope(Eigen::VectorXd const& theta) const;

  /// Whether a coordinate lies at a bound.
  bool at_low(Eigen::VectorXd const& z, Eigen::Index p) const;
  bool at_high(Eigen::VectorXd const& z, Eigen::Index p) const;

  Eigen::VectorXd const& low() const { return low_; }
  Eigen::VectorXd const& high() const { return high_; }
  /// Of the prior, in z.
  Eigen::VectorXd const& width() const { return width_; }

 private:
  enum class Kind { line, half_line, interval };

  std::vector<Kind> kinds_;
  Eigen::VectorXd middle_;            // m
  Eigen::VectorXd lowest_, highest_;  // theta
  Eigen::VectorXd low_, high_, width_;
};

}  // namespace sysid
