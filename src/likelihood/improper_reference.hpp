// What stands in the place of draws where a prior is improper: where a search looks, and how wide its steps are. It is no part of
// the posterior.
#pragma once
#include "core/numeric/random.hpp"

namespace sysid {

/// How near to the only bound of its prior a parameter is looked for, as a share of the bound: nearer, its value has too few digits
/// for its distance.
constexpr double least_distance = 1e-12;

/// Of one coordinate of a parameter space.
struct ImproperReference {
  enum class Kind {
    decades,  // the distance from zero, or from the bound, is log-uniform over 10^(centre - width) to 10^(centre + width) declared
              // units, on either side of zero
    normal,   // in the sampler's coordinate, with this mean and sd
  };
  Kind kind = Kind::decades;
  int coordinate = 0;
  double centre = 0, width = 3;

  /// A value between bounds, which may be infinite, in a unit of `unit` each.
  double draw(double lower, double upper, double unit, Stream& stream) const;
  /// The normal density at a place of the sampler's coordinate; of `decades` only its value at the centre is used.
  double log_density(double theta) const;

  friend bool operator==(ImproperReference const&, ImproperReference const&) = default;
};

}  // namespace sysid
