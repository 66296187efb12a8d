// Columns whose names or numbers contradict the data block: units, times, columns that are used twice.
#pragma once
#include "experiment/experiments.hpp"
#include "result/finding.hpp"

namespace sysid {

/// `unit_in_file` for each column of a file without `read` that states a unit of another kind of quantity than the data block;
/// `unit_in_name` for each column whose name ends in another unit of the same kind than that in which it is read: a note where the
/// data block states this unit, else a warning; always one where the name of the time is the unit in a word, `minutes`.
Findings find_other_units(ExperimentData const& data);

/// `times_rounded`, a warning, where times are read as they stand and equal steps give them by rounding.
Findings find_rounded_times(CheckedFile const& file, ExperimentData const& data, Model const& model);

/// `rate_contradicted` where the block says by `rate` or `step` when its rows were taken, and a column of the file says something
/// else: a note where only the steps of this column look like those of a time, or where another unit of it would agree.
Findings find_contradicted_rate(CheckedFile const& file, ExperimentData const& data, Model const& model);

/// `column_used_twice`, a warning, where a channel is measured by a column that is also the time, an input of the model or another
/// of its channels, or that is called and looks like the time.
Findings find_shared_columns(CheckedFile const& file, ExperimentData const& data, Model const& model);

}  // namespace sysid
