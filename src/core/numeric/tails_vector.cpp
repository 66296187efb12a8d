// Sorting by insertion, without branches (compiled for the vectors of the processor, see CMakeLists.txt).
#include "core/numeric/tails.hpp"

#include <cstring>

namespace sysid {
namespace {

typedef double Vector __attribute__((vector_size(32)));

Vector load(double const* from) {
  Vector four;
  std::memcpy(&four, from, sizeof four);
  return four;
}

void store(Vector four, double* to) { std::memcpy(to, &four, sizeof four); }

}  // namespace

void add_to_tails(double* smallest, double* largest, int depth, double const* next) {
  for (int half = 0; half < sequences_at_once; half += 4) {
    Vector up = load(next + half), down = up;
    for (int r = 0; r < depth; ++r) {
      double* const small = smallest + r * sequences_at_once + half;
      double* const large = largest + r * sequences_at_once + half;
      Vector const least = load(small), most = load(large);
      store(least < up ? least : up, small);
      up = least > up ? least : up;
      store(most > down ? most : down, large);
      down = most < down ? most : down;
    }
  }
}

}  // namespace sysid
