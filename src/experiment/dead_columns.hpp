// Columns that do not change.
#pragma once
#include "experiment/experiments.hpp"
#include "result/finding.hpp"

namespace sysid {

/// `column_constant` of each channel that is one number in ten scored samples or more: a warning. Of each input that is one number
/// in the rows that are simulated: a warning if it is in the whole file, else a note. Counts, and rows without order, are left
/// alone: there a constant is a result.
Findings find_constant_columns(CheckedFile const& file, ExperimentData const& data, Model const& model);

}  // namespace sysid
