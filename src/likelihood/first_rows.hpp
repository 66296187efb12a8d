// Experiments cut to their first rows: a search begins with a part of the record, which costs a part of the time.
#pragma once
#include <span>
#include <vector>

#include "data/experiment.hpp"

namespace sysid {

/// Rows that are scored in any channel, of the experiment that has most of them.
int most_scored_rows(std::span<Experiment const> experiments);

struct FirstRows {
  std::vector<Experiment> experiments;
  double share;  // of all rows that a simulation runs over
};

/// Each experiment up to the row that completes `share` of its scored rows, no fewer than `least` of them. An experiment that has
/// fewer stays whole.
FirstRows first_rows(std::span<Experiment const> experiments, double share, int least);

}  // namespace sysid
