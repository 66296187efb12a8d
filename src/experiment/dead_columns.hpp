// Columns that do not change, and times at which a recorder stood still.
#pragma once
#include "experiment/experiments.hpp"
#include "result/finding.hpp"

namespace sysid {

/// `column_constant` of each channel that is one number in ten scored samples or more: a warning. Of each input that is one number
/// in the rows that are simulated: a warning if it is in the whole file, else a note. Counts, and rows without order, are left
/// alone: there a constant is a result.
Findings find_constant_columns(CheckedFile const& file, ExperimentData const& data, Model const& model);

/// `time_gap`, a warning, where the rows that are simulated follow each other at one step (nine in ten are within a tenth of the
/// median) and two of them are more than ten such steps apart.
Findings find_time_gaps(CheckedFile const& file, ExperimentData const& data, Model const& model);

}  // namespace sysid
