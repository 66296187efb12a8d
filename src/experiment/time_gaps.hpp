// Gaps in the times of a record, and how a fit leaves them out.
#pragma once
#include "experiment/experiments.hpp"
#include "result/finding.hpp"

namespace sysid {

/// `time_gap`, a warning, where the rows that are simulated follow each other at one step (nine in ten are within a tenth of the
/// median) and two of them are more than ten such steps apart. Its help has the lines that leave the gaps out: ranges between them,
/// and where the simulation of each begins, since with `start = record` it would go through the gaps before its range.
Findings find_time_gaps(CheckedFile const& file, ExperimentData const& data, Model const& model);

}  // namespace sysid
