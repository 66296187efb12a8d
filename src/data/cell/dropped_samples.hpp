// Zeros among the numbers of a sensor that moved on: samples that a transmission or a logger lost.
#pragma once
#include <cstddef>
#include <vector>

namespace sysid {

/// The places of all exact zeros among `values` (NaN: missing), ascending, where at least three of them, and at least half, stand
/// alone or in twos and threes far from the straight line between their neighbours: three times as far as nine tenths of the other
/// samples are from theirs. A zero that lies on the line through the two samples before or behind it, to as much, is a sample: at a
/// corner of the signal, or where an angle begins again. Else none; none either where a fifth of the values or more are zero, or
/// where the others are fewer than ten different numbers, as those of a switch are.
std::vector<std::size_t> dropped_samples(std::vector<double> const& values);

}  // namespace sysid
