// Whether the upper halves of the vector registers are clear: until they are, whatever is compiled for narrower vectors is slow.
#pragma once
#include <algorithm>
#include <iterator>

namespace sysid::testing {

/// Asked directly after a call; other processors than x86-64 have no such halves.
inline bool upper_halves_are_clear() {
#if defined(__x86_64__)
  unsigned char halves[8 * 16];
  asm volatile(
      "vextractf128 $1, %%ymm0, (%0)\n vextractf128 $1, %%ymm1, 16(%0)\n"
      "vextractf128 $1, %%ymm2, 32(%0)\n vextractf128 $1, %%ymm3, 48(%0)\n"
      "vextractf128 $1, %%ymm4, 64(%0)\n vextractf128 $1, %%ymm5, 80(%0)\n"
      "vextractf128 $1, %%ymm6, 96(%0)\n vextractf128 $1, %%ymm7, 112(%0)\n"
      :
      : "r"(halves)
      : "memory");
  return std::all_of(std::begin(halves), std::end(halves), [](unsigned char part) { return part == 0; });
#else
  return true;
#endif
}

}  // namespace sysid::testing
