// Rows in which an input has no value: a record may have them, a run may not use them.
#pragma once
#include <vector>

#include "data/record.hpp"

namespace sysid {

/// Puts a straight line from row to row in the place of NaN, at an end the nearest value; `input`, `line`, `column` and `mention`
/// are for the caller. values: not all NaN.
std::vector<InputGap> bridge_gaps(std::vector<double>& values);

/// UserError E4013 where a gap lies in the rows that a run reads of its inputs, or where the rule of the input reads around them.
/// simulated: those of them that it simulates.
void refuse_gaps(Record const& record, RowRange used, RowRange simulated);

}  // namespace sysid
