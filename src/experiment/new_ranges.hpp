// Ranges of rows that a help proposes in place of those that a task has.
#pragma once
#include <string>
#include <vector>

#include "experiment/experiments.hpp"

namespace sysid {

/// "write `split part_1 = rows 1..120, part_2 = rows 121..300` in `rec`, and fit to `rec.part_1, rec.part_2`": in place of the
/// range that the task has, or of the whole `split`, since ranges do not overlap. ranges: one at least, in the rows of the task.
std::string new_ranges(DataBlock const& block, int part, std::vector<RowRange> const& ranges);

}  // namespace sysid
