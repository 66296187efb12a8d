// The smallest and the largest numbers of several sequences at once: what tails_vector.cpp offers to bands over draws.
#pragma once

namespace sysid {

/// Sequences side by side.
inline constexpr int sequences_at_once = 8;

/// Takes the next number of each sequence into its `depth` smallest and largest ones so far, rows of sequences from the outermost
/// number on; none is NaN.
void add_to_tails(double* smallest, double* largest, int depth, double const* next);

}  // namespace sysid
