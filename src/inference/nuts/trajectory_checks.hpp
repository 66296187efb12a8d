// Checks of Hamiltonian trajectories: those whose steps did not follow the density, and those that were cut short.
#pragma once
#include <vector>

#include "inference/nuts/chain.hpp"
#include "likelihood/target.hpp"
#include "result/draws.hpp"
#include "result/finding.hpp"

namespace sysid::nuts {

/// An error from here on: where so many trajectories diverge the posterior has a part that the steps do not enter.
inline constexpr double most_divergent = 0.01;
/// A warning from here on.
inline constexpr double most_cut = 0.01;

struct TrajectoryReport {
  Target const& target;
  Draws const& draws;
  std::vector<Tally> const& tallies;  // of each chain, after burn-in
  double acceptance;                  // settings
  int depth;
};

/// trajectories_diverge names the parameter in which they lie farthest from the posterior's middle, with where half of them began;
/// trajectories_cut tells how many were still going straight after all doublings.
Findings check_trajectories(TrajectoryReport const& report);

}  // namespace sysid::nuts
