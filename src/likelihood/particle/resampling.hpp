// Which particles go on: by systematic resampling along a curve through their states, which keeps the parts of the cloud in
// proportion, so that estimates scatter less.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/numeric/lanes.hpp"

namespace sysid {

/// Along a Hilbert curve through the box of 4 sds to either side of the mean: states [S x N], of which the first 8 count that are
/// not the same in all particles; 16 bits of a place. Returns the particles in that order.   Gerber, Chopin 2015, sec. 4.3
class ParticleOrder {
 public:
  explicit ParticleOrder(int count);
  std::span<int const> operator()(ConstLanes states);

 private:
  struct Axis {
    int state;
    double low, scale;
  };
  void find_axes(ConstLanes states);

  std::vector<Axis> axes_;
  std::vector<std::uint16_t> points_, places_;  // [axes x N], [N]
  std::vector<int> order_, sorted_;
};

/// The places on the curve [N] of points [axes x N] whose coordinates have `bits` bits, 16 or less in all; changes the points.
/// Many at a time, without a branch.                                                                    Skilling 2004
void hilbert_places(std::span<std::uint16_t> points, int axes, int bits, std::span<std::uint16_t> places);

/// Ancestors of particles of equal weight: the k-th is the one in whose share of the weights, added up in `order`, the point
/// (uniform + k)/N lies. weights: not negative, their sum positive.                        Douc, Cappé, Moulines 2005, sec. 2.4
void systematic_ancestors(std::span<double const> weights, std::span<int const> order, double uniform, std::span<int> ancestors);

}  // namespace sysid
