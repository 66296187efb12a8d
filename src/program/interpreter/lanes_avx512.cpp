// The lane executor for AVX-512 (see CMakeLists.txt for how it is compiled): vectors of eight lanes.
#include <immintrin.h>

#include "program/interpreter/step.hpp"

namespace sysid::avx512 {
namespace {

using Vec = __m512d;
constexpr int vector_lanes = 8;
constexpr int vector_bytes = 64;
constexpr __mmask8 all = 0xff;  // the unmasked forms of some intrinsics warn of an undefined source in GCC 12

inline Vec load(char const* p) { return _mm512_load_pd(p); }
inline void store(char* p, Vec v) { _mm512_store_pd(p, v); }
inline Vec broadcast(char const* p) { return _mm512_set1_pd(*reinterpret_cast<double const*>(p)); }
inline Vec zero() { return _mm512_setzero_pd(); }
inline Vec negate_of(Vec a) { return _mm512_xor_pd(a, _mm512_set1_pd(-0.0)); }
inline Vec add_of(Vec a, Vec b) { return _mm512_add_pd(a, b); }
inline Vec subtract_of(Vec a, Vec b) { return _mm512_sub_pd(a, b); }
inline Vec multiply_of(Vec a, Vec b) { return _mm512_mul_pd(a, b); }
inline Vec divide_of(Vec a, Vec b) { return _mm512_div_pd(a, b); }
inline Vec fused_of(Vec a, Vec b, Vec c) { return _mm512_fmadd_pd(a, b, c); }
inline Vec fused_subtract_of(Vec a, Vec b, Vec c) { return _mm512_fmsub_pd(a, b, c); }
inline Vec fused_negate_of(Vec a, Vec b, Vec c) { return _mm512_fnmadd_pd(a, b, c); }
inline Vec fused_both_of(Vec a, Vec b, Vec c) { return _mm512_fnmsub_pd(a, b, c); }
inline Vec square_root_of(Vec a) { return _mm512_maskz_sqrt_pd(all, a); }
inline Vec absolute_of(Vec a) { return _mm512_andnot_pd(_mm512_set1_pd(-0.0), a); }
inline Vec floor_of(Vec a) { return _mm512_maskz_roundscale_pd(all, a, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC); }
inline Vec minimum_of(Vec a, Vec b) { return _mm512_maskz_min_pd(all, a, b); }  // a < b ? a : b, also for NaN and zeros
inline Vec maximum_of(Vec a, Vec b) { return _mm512_maskz_max_pd(all, a, b); }
inline Vec condition(__mmask8 mask) { return _mm512_maskz_mov_pd(mask, _mm512_set1_pd(1.0)); }
inline Vec less_of(Vec a, Vec b) { return condition(_mm512_cmp_pd_mask(a, b, _CMP_LT_OQ)); }
inline Vec less_equal_of(Vec a, Vec b) { return condition(_mm512_cmp_pd_mask(a, b, _CMP_LE_OQ)); }
inline Vec equal_of(Vec a, Vec b) { return condition(_mm512_cmp_pd_mask(a, b, _CMP_EQ_OQ)); }
inline Vec not_equal_of(Vec a, Vec b) { return condition(_mm512_cmp_pd_mask(a, b, _CMP_NEQ_UQ)); }
inline Vec select_of(Vec a, Vec b, Vec c) { return _mm512_mask_mov_pd(c, _mm512_cmp_pd_mask(a, zero(), _CMP_NEQ_UQ), b); }

#include "program/interpreter/lanes_handlers.hpp"

}  // namespace
}  // namespace sysid::avx512

namespace sysid::avx512 {

Handler handler(Shape shape, int width) {
  return ask<Handler>(width, [&]<class M>(M) { return M::handler(shape); });
}

Handler end(int width) {
  return ask<Handler>(width, []<class M>(M) { return reinterpret_cast<Handler>(&M::end); });
}

void run(Step const* steps, char* file, int width) {
  ask<void>(width, [&]<class M>(M) { M::run(steps, file); });
}

}  // namespace sysid::avx512
