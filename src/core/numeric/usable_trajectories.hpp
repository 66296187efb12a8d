// Which of several trajectories have a value wherever any of them has one.
#pragma once
#include <vector>

namespace sysid {

/// The draws of trajectories[d][i] that are finite wherever another is. Samples that no draw can predict, because what they follow
/// from was not measured, say nothing about a draw.
struct UsableTrajectories {
  std::vector<std::vector<double> const*> usable;
  std::vector<char> predictable;  // [samples] 1: some draw is finite there
};
UsableTrajectories usable_trajectories(std::vector<std::vector<double>> const& trajectories);

}  // namespace sysid
