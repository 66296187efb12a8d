// SplitMix64's finaliser, number after number.
#include "core/numeric/column_word.hpp"

#include <bit>

namespace sysid {

std::uint64_t word_of(ConstLanes theta, int lane) {
  std::uint64_t word = 0;
  for (int p = 0; p < theta.rows(); ++p) {
    word += std::bit_cast<std::uint64_t>(theta(p, lane)) + 0x9e3779b97f4a7c15;
    word = (word ^ (word >> 30)) * 0xbf58476d1ce4e5b9;
    word = (word ^ (word >> 27)) * 0x94d049bb133111eb;
    word ^= word >> 31;
  }
  return word;
}

}  // namespace sysid
