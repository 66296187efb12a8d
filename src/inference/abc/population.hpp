// Particles of one population.
#pragma once
#include <vector>

#include "core/numeric/lanes.hpp"
#include "inference/abc/kernel.hpp"

namespace sysid::abc {

/// Accepted particles of one model, in the order of their proposals.
struct Particles {
  std::vector<double> at;  // [count x D], coordinates of the walk
  std::vector<double> log_prior, distance, weight;

  int count() const { return static_cast<int>(distance.size()); }
  void add(ConstLanes x, int lane, double log_prior_there, double distance_there);
  /// [D x count].
  LaneArray lanes(int dimension) const;
  double weight_sum() const;
};

/// All that carries over from one population to the next.
struct Population {
  int number = 0;  // from 1; 0: none yet
  double threshold = 0;
  std::vector<Particles> models;  // weights sum to 1 over all of them
  std::vector<Width> widths;      // per model

  int accepted() const;
  /// 1 / sum w^2.
  double ess() const;
  /// The smallest distance that at least this part of all particles, of equal weight, does not exceed.
  double quantile(double part) const;
};

}  // namespace sysid::abc
