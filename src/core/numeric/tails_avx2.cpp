// Sorting by insertion, without branches (compiled for AVX2, see CMakeLists.txt).
#include "core/numeric/tails.hpp"

#include <immintrin.h>

namespace sysid {

void add_to_tails(double* smallest, double* largest, int depth, double const* next) {
  for (int half = 0; half < sequences_at_once; half += 4) {
    __m256d up = _mm256_loadu_pd(next + half), down = up;
    for (int r = 0; r < depth; ++r) {
      double *const small = smallest + r * sequences_at_once + half, *const large = largest + r * sequences_at_once + half;
      __m256d const least = _mm256_loadu_pd(small), most = _mm256_loadu_pd(large);
      _mm256_storeu_pd(small, _mm256_min_pd(least, up));
      up = _mm256_max_pd(least, up);
      _mm256_storeu_pd(large, _mm256_max_pd(most, down));
      down = _mm256_min_pd(most, down);
    }
  }
}

}  // namespace sysid
