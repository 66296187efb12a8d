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
inline void leave() { _mm256_zeroupper(); }
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
inline Vec with_nan_of(Vec result, Vec a) { return _mm512_mask_mov_pd(result, _mm512_cmp_pd_mask(a, a, _CMP_UNORD_Q), a); }
inline Vec minimum_of(Vec a, Vec b) {
  return with_nan_of(_mm512_maskz_min_pd(all, a, b), a);
}  // a < b ? a : b, also for NaN, zeros
inline Vec maximum_of(Vec a, Vec b) { return with_nan_of(_mm512_maskz_max_pd(all, a, b), a); }
inline Vec condition(__mmask8 mask) { return _mm512_maskz_mov_pd(mask, _mm512_set1_pd(1.0)); }
// Where operands have no order, a comparison leaves a NaN.
inline Vec compared(Vec a, Vec b, __mmask8 mask) {
  return _mm512_mask_mov_pd(condition(mask), _mm512_cmp_pd_mask(a, b, _CMP_UNORD_Q), _mm512_set1_pd(__builtin_nan("")));
}
inline Vec less_of(Vec a, Vec b) { return compared(a, b, _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ)); }
inline Vec less_equal_of(Vec a, Vec b) { return compared(a, b, _mm512_cmp_pd_mask(a, b, _CMP_LE_OQ)); }
inline Vec equal_of(Vec a, Vec b) { return compared(a, b, _mm512_cmp_pd_mask(a, b, _CMP_EQ_OQ)); }
inline Vec both_of(Vec a, Vec b) {
  auto const no_false_one =
      static_cast<__mmask8>(~(_mm512_cmp_pd_mask(a, zero(), _CMP_EQ_OQ) | _mm512_cmp_pd_mask(b, zero(), _CMP_EQ_OQ)));
  return _mm512_maskz_mov_pd(no_false_one, compared(a, b, all));
}
inline Vec either_of(Vec a, Vec b) {
  auto const true_one =
      static_cast<__mmask8>(_mm512_cmp_pd_mask(a, zero(), _CMP_NEQ_OQ) | _mm512_cmp_pd_mask(b, zero(), _CMP_NEQ_OQ));
  return _mm512_mask_mov_pd(compared(a, b, 0), true_one, _mm512_set1_pd(1.0));
}
inline Vec select_of(Vec a, Vec b, Vec c) {
  return with_nan_of(_mm512_mask_mov_pd(c, _mm512_cmp_pd_mask(a, zero(), _CMP_NEQ_UQ), b), a);
}

#include "program/interpreter/lanes_handlers.hpp"

}  // namespace

#include "program/interpreter/lanes_offered.hpp"

}  // namespace sysid::avx512
