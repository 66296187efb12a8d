// The samples at which a run of a block of lanes pauses, to remove failed or unwanted lanes: the same for every width and executor
// where results depend on it.
#pragma once
#include <algorithm>

#include "simulate/block.hpp"

namespace sysid {

/// Dead lanes are looked for after every so many samples.
constexpr int burial_interval = 64;

/// Steps of machine code that take some milliseconds.
constexpr int steps_between_looks = 4096;

/// Where a block that is at sample `from` is looked at next: machine code runs on to where dead lanes are looked for, unless it
/// takes many steps from sample to sample; what is slower can be stopped at every sample.
inline int next_look(Block const& block, int substeps, int from, int end) {
  if (!block.runs_loops()) return from + 1;
  int const most = std::max(1, steps_between_looks / substeps);
  return std::min({end, from + most, (from / burial_interval + 1) * burial_interval});
}

}  // namespace sysid
