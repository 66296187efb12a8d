// Sorting by insertion, without branches (compiled for the vectors of the processor, see CMakeLists.txt).
#include "core/numeric/tails.hpp"

namespace sysid {
namespace {

typedef double Vector __attribute__((vector_size(32)));
typedef double Unaligned __attribute__((vector_size(32), aligned(8), may_alias));

}  // namespace

void add_to_tails(double* smallest, double* largest, int depth, double const* next) {
  for (int half = 0; half < sequences_at_once; half += 4) {
    Vector up = *reinterpret_cast<Unaligned const*>(next + half), down = up;
    for (int r = 0; r < depth; ++r) {
      auto& small = *reinterpret_cast<Unaligned*>(smallest + r * sequences_at_once + half);
      auto& large = *reinterpret_cast<Unaligned*>(largest + r * sequences_at_once + half);
      Vector const least = small, most = large;
      small = least < up ? least : up;
      up = least > up ? least : up;
      large = most > down ? most : down;
      down = most < down ? most : down;
    }
  }
}

}  // namespace sysid
