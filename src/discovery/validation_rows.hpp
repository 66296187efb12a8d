// Which rows a validation by simulation fits and scores, and over which lengths.
#pragma once
#include <string>
#include <vector>

#include "data/experiment.hpp"
#include "experiment/experiments.hpp"

namespace sysid {

/// Experiments have the dictionary's columns.
struct ValidationRows {
  std::vector<Experiment> records;   // those of the task
  std::vector<Experiment> held_out;  // those that are scored; may be empty
  std::vector<int> ends;             // of each record: its rows before those that are scored
  bool cut = false;           // those that are scored are the last fifths of records, or quarters, where these hold samples enough
  std::string held_out_name;  // "bench.test", "the last fifth of bench"
  double step = 0;            // [s] between rows
  int horizon = 1;            // rows of one dominant period, as far as the scored rows allow
  int window = 1;             // rows from which a start is estimated
  int least = 2;              // rows of the shortest segments
};

/// task, unused: of the task, and parts of its blocks that it does not use. states: of the largest model. half_width: of the
/// regression's windows, 0 for none.
ValidationRows validation_rows(std::vector<ExperimentData> const& task, std::vector<ExperimentData> const& unused, int states,
                               int half_width);

}  // namespace sysid
