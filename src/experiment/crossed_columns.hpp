// Columns that are read for another quantity than the one of their name.
#pragma once
#include "experiment/experiments.hpp"
#include "result/finding.hpp"

namespace sysid {

/// `column_used_twice`, a warning, where an input or a channel of the model is read from another column than the one of its name,
/// and this column is read for something else: `input load = temp` beside `input temp = load`. A name of one letter counts only if
/// the two are exchanged, since `u` and `y` mean something else in each file.
Findings find_crossed_columns(CheckedFile const& file, ExperimentData const& data, Model const& model);

}  // namespace sysid
