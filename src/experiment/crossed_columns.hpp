// Columns that are read for another quantity than the one of their name.
#pragma once
#include <string>
#include <vector>

#include "experiment/experiments.hpp"
#include "result/finding.hpp"

namespace sysid {

/// `column_used_twice`, a warning, where an input or a channel of the model is read from another column than the one of its name,
/// and this column is read for something else: `input load = temp` beside `input temp = load`. A name of one letter counts only if
/// the two are exchanged, since `u` and `y` mean something else in each file.
Findings find_crossed_columns(CheckedFile const& file, ExperimentData const& data, Model const& model);

/// A data block in which two columns have changed places: each is read in the unit of its new place.
struct ExchangedColumns {
  DataBlock block;
  std::string one, other;   // the columns
  bool of_channel = false;  // a channel takes part
  std::string lines;        // that write it, "`input x = force [N] hold zero_order` and `measure position = pos [mm]`"
};
/// All pairs of columns that a model reads, one of them at least for an input, of a block that reads no column twice.
std::vector<ExchangedColumns> exchanged_columns(DataBlock const& block, Model const& model);

}  // namespace sysid
