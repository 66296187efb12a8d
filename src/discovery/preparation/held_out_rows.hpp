// Rows that a discovery did not use: what its answer may be scored on.
#pragma once
#include <vector>

#include "check/checked/checked.hpp"

namespace sysid {

/// Parts of the task's data blocks that share no row with those it uses and have more than `least` rows, in the order of the blocks
/// in the task; none of a block that it uses whole.
std::vector<ExperimentUse> unused_parts(CheckedFile const& file, DiscoverTask const& task, int least);

}  // namespace sysid
