// Numbers that stand for a missing sample in many files: which they are, and when one of them is doubted. One rule for every
// reader.
#pragma once
#include <cstddef>
#include <vector>

namespace sysid {

struct DoubtfulNumber {
  double value = 0;
  std::vector<std::size_t> places;  // in the values, ascending
};

/// The marks among `values` (NaN: missing) that are far from all other samples. A mark is a number of three nines or more,
/// from 9.99 on (99.9, -999, 9999), the end of a 16-bit or 32-bit range, or one of those that instruments are known for
/// (1e30, 9.91e37). Far is five times as large as the largest of the others, and five times as far from them as they are apart;
/// below them, where a mark of -999 or less is, five times as large is enough. Others of one value, as those of a switch are, doubt
/// no mark above them.
std::vector<DoubtfulNumber> doubtful_numbers(std::vector<double> const& values);

}  // namespace sysid
