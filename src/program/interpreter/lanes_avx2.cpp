// The lane executor for AVX2 and FMA (see CMakeLists.txt for how it is compiled): vectors of four lanes.
#include <immintrin.h>

#include "program/interpreter/step.hpp"

namespace sysid::avx2 {
namespace {

using Vec = __m256d;
constexpr int vector_lanes = 4;
constexpr int vector_bytes = 32;

inline Vec load(char const* p) { return _mm256_load_pd(reinterpret_cast<double const*>(p)); }
inline void store(char* p, Vec v) { _mm256_store_pd(reinterpret_cast<double*>(p), v); }
inline Vec broadcast(char const* p) { return _mm256_broadcast_sd(reinterpret_cast<double const*>(p)); }
inline Vec zero() { return _mm256_setzero_pd(); }
inline void leave() { _mm256_zeroupper(); }
inline Vec negate_of(Vec a) { return _mm256_xor_pd(a, _mm256_set1_pd(-0.0)); }
inline Vec add_of(Vec a, Vec b) { return _mm256_add_pd(a, b); }
inline Vec subtract_of(Vec a, Vec b) { return _mm256_sub_pd(a, b); }
inline Vec multiply_of(Vec a, Vec b) { return _mm256_mul_pd(a, b); }
inline Vec divide_of(Vec a, Vec b) { return _mm256_div_pd(a, b); }
inline Vec fused_of(Vec a, Vec b, Vec c) { return _mm256_fmadd_pd(a, b, c); }
inline Vec fused_subtract_of(Vec a, Vec b, Vec c) { return _mm256_fmsub_pd(a, b, c); }
inline Vec fused_negate_of(Vec a, Vec b, Vec c) { return _mm256_fnmadd_pd(a, b, c); }
inline Vec fused_both_of(Vec a, Vec b, Vec c) { return _mm256_fnmsub_pd(a, b, c); }
inline Vec square_root_of(Vec a) { return _mm256_sqrt_pd(a); }
inline Vec absolute_of(Vec a) { return _mm256_andnot_pd(_mm256_set1_pd(-0.0), a); }
inline Vec floor_of(Vec a) { return _mm256_floor_pd(a); }
inline Vec with_nan_of(Vec result, Vec a) { return _mm256_blendv_pd(result, a, _mm256_cmp_pd(a, a, _CMP_UNORD_Q)); }
inline Vec minimum_of(Vec a, Vec b) {
  return with_nan_of(_mm256_min_pd(a, b), a);
}  // min_pd: a < b ? a : b, also for NaN and zeros
inline Vec maximum_of(Vec a, Vec b) { return with_nan_of(_mm256_max_pd(a, b), a); }
inline Vec condition(Vec mask) { return _mm256_and_pd(mask, _mm256_set1_pd(1.0)); }
// All bits set is a NaN: where operands have no order, that is what a comparison leaves.
inline Vec compared(Vec a, Vec b, Vec mask) { return _mm256_or_pd(condition(mask), _mm256_cmp_pd(a, b, _CMP_UNORD_Q)); }
inline Vec less_of(Vec a, Vec b) { return compared(a, b, _mm256_cmp_pd(a, b, _CMP_LT_OQ)); }
inline Vec less_equal_of(Vec a, Vec b) { return compared(a, b, _mm256_cmp_pd(a, b, _CMP_LE_OQ)); }
inline Vec equal_of(Vec a, Vec b) { return compared(a, b, _mm256_cmp_pd(a, b, _CMP_EQ_OQ)); }
inline Vec both_of(Vec a, Vec b) {
  Vec const false_one = _mm256_or_pd(_mm256_cmp_pd(a, zero(), _CMP_EQ_OQ), _mm256_cmp_pd(b, zero(), _CMP_EQ_OQ));
  return _mm256_andnot_pd(false_one, compared(a, b, _mm256_cmp_pd(zero(), zero(), _CMP_EQ_OQ)));
}
inline Vec either_of(Vec a, Vec b) {
  Vec const true_one = _mm256_or_pd(_mm256_cmp_pd(a, zero(), _CMP_NEQ_OQ), _mm256_cmp_pd(b, zero(), _CMP_NEQ_OQ));
  return _mm256_blendv_pd(_mm256_cmp_pd(a, b, _CMP_UNORD_Q), condition(true_one), true_one);
}
inline Vec select_of(Vec a, Vec b, Vec c) { return with_nan_of(_mm256_blendv_pd(c, b, _mm256_cmp_pd(a, zero(), _CMP_NEQ_UQ)), a); }

#include "program/interpreter/lanes_handlers.hpp"

}  // namespace

#include "program/interpreter/lanes_offered.hpp"

}  // namespace sysid::avx2
