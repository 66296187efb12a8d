// Filters of linear models whose covariance has settled: it does not depend on the samples, and comes to a limit along a record
// with equal steps and no gaps. From there on only means move, with gains that are computed once per parameter vector.
#pragma once
#include <optional>
#include <vector>

#include "program/simulation_program.hpp"

namespace sysid {

struct SettledSource {
  /// The states that still move; those that are fixed have become parameters, behind those that there are: their values at a
  /// sample, before it is summed. Initial states are 0.
  SimulationSource source;
  std::vector<int> moving, fixed;  // states of the given source, in the order of its states
};

struct SettledProgram {
  SimulationProgram program;
  std::vector<int> moving, fixed;
};

/// Nothing where nothing settles. What settles is `SimulationSource::settling` with all else, such as derivatives by parameters,
/// that reads neither data nor states that depend on data. Programs with records have none.
std::optional<SettledSource> settled_source(SimulationSource const& source);

}  // namespace sysid
