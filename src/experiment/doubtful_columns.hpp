// Columns that are read as the data block says, though their names or their numbers say something else.
#pragma once
#include "experiment/experiments.hpp"
#include "result/finding.hpp"

namespace sysid {

/// `unit_in_name` for each column whose name ends in another unit of the same kind than that in which it is read: a note where the
/// data block states this unit, else a warning.
Findings find_other_units(ExperimentData const& data);

/// `times_rounded`, a warning, where times are read as they stand and equal steps give them by rounding.
Findings find_rounded_times(CheckedFile const& file, ExperimentData const& data, Model const& model);

}  // namespace sysid
