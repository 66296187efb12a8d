// How many samples a likelihood reads.
#pragma once
#include "data/experiment.hpp"

namespace sysid {

/// Of one channel; 0 where it was not recorded.
inline int scored_count(Experiment const& experiment, std::size_t channel) {
  int count = 0;
  for (std::size_t i = 0; i < experiment.measured[channel].size(); ++i) count += experiment.is_scored(channel, i) ? 1 : 0;
  return count;
}
/// Of all channels.
inline int scored_count(Experiment const& experiment) {
  int count = 0;
  for (std::size_t c = 0; c < experiment.measured.size(); ++c) count += scored_count(experiment, c);
  return count;
}

}  // namespace sysid
