// Numbers in a record that mark missing measurements.
#pragma once
#include <string>
#include <vector>

#include "experiment/experiments.hpp"
#include "result/finding.hpp"

namespace sysid {

/// A warning `looks_missing` for each number of the rows that are simulated that `doubtful_numbers` doubts, as it stands in the
/// file: what E4022 refuses before in a text file whose data block says nothing of missing samples. So it is about files that have
/// no `read`, about marks beside those that `missing` lists, and about those that stand out of a part of the rows alone. Of
/// channels only rows that are scored, or that a model in discrete time may go on from, and `dropped_samples` as well. None where
/// the block has `missing = none`.
Findings find_placeholders(CheckedFile const& file, ExperimentData const& data, Model const& model);

/// "write `read missing = "-9999"` in the data block", for numbers of a channel's column as they stand in the file: what the block
/// has is kept. Where another column that is used has one of them, and not as a mark, to empty the cells.
std::string to_be_missing(DataBlock const& block, ExperimentData const& data, Model const& model, std::string const& column,
                          std::vector<double> const& numbers);

}  // namespace sysid
