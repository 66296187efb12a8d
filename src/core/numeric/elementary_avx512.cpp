// Elementary functions over vectors of 8 lanes (compiled for AVX-512, see CMakeLists.txt): SLEEF's deterministic family.
#include <immintrin.h>

#include "core/numeric/elementary_vector.hpp"

#define SYSID_UNARY(name, accuracy) extern "C" __m512d Sleef_finz_##name##d8_##accuracy##avx512f(__m512d);
#define SYSID_BINARY(name, accuracy) extern "C" __m512d Sleef_finz_##name##d8_##accuracy##avx512f(__m512d, __m512d);
SYSID_ELEMENTARY_UNARY(SYSID_UNARY)
SYSID_ELEMENTARY_BINARY(SYSID_BINARY)
#undef SYSID_UNARY
#undef SYSID_BINARY

namespace sysid::elementary::avx512 {

#define SYSID_UNARY(name, accuracy)                                                                 \
  void name(double const* x, double* out, int width) {                                              \
    for (int i = 0; i < width; i += 8)                                                              \
      _mm512_storeu_pd(out + i, Sleef_finz_##name##d8_##accuracy##avx512f(_mm512_loadu_pd(x + i))); \
  }
#define SYSID_BINARY(name, accuracy)                                                                                        \
  void name(double const* x, double const* y, double* out, int width) {                                                     \
    for (int i = 0; i < width; i += 8)                                                                                      \
      _mm512_storeu_pd(out + i, Sleef_finz_##name##d8_##accuracy##avx512f(_mm512_loadu_pd(x + i), _mm512_loadu_pd(y + i))); \
  }
SYSID_ELEMENTARY_UNARY(SYSID_UNARY)
SYSID_ELEMENTARY_BINARY(SYSID_BINARY)
#undef SYSID_UNARY
#undef SYSID_BINARY

#define SYSID_FORM(name, accuracy) \
  void const* name##_form() { return reinterpret_cast<void const*>(&Sleef_finz_##name##d8_##accuracy##avx512f); }
SYSID_ELEMENTARY_UNARY(SYSID_FORM)
SYSID_ELEMENTARY_BINARY(SYSID_FORM)
#undef SYSID_FORM

}  // namespace sysid::elementary::avx512
