// The lane executor for AArch64: vectors of two lanes. No more than eight are side by side, which is what the calling convention
// passes in registers.
#include <arm_neon.h>

#include "program/interpreter/step.hpp"

namespace sysid::neon {
namespace {

using Vec = float64x2_t;
using Mask = uint64x2_t;
constexpr int vector_lanes = 2;
constexpr int vector_bytes = 16;

inline Vec load(char const* p) { return vld1q_f64(reinterpret_cast<double const*>(p)); }
inline void store(char* p, Vec v) { vst1q_f64(reinterpret_cast<double*>(p), v); }
inline Vec broadcast(char const* p) { return vld1q_dup_f64(reinterpret_cast<double const*>(p)); }
inline Vec zero() { return vdupq_n_f64(0); }
inline void leave() {}
inline Vec one() { return vdupq_n_f64(1); }
inline Vec negate_of(Vec a) { return vnegq_f64(a); }
inline Vec add_of(Vec a, Vec b) { return vaddq_f64(a, b); }
inline Vec subtract_of(Vec a, Vec b) { return vsubq_f64(a, b); }
inline Vec multiply_of(Vec a, Vec b) { return vmulq_f64(a, b); }
inline Vec divide_of(Vec a, Vec b) { return vdivq_f64(a, b); }
inline Vec fused_of(Vec a, Vec b, Vec c) { return vfmaq_f64(c, a, b); }
inline Vec fused_subtract_of(Vec a, Vec b, Vec c) { return vfmaq_f64(vnegq_f64(c), a, b); }
inline Vec fused_negate_of(Vec a, Vec b, Vec c) { return vfmsq_f64(c, a, b); }
inline Vec fused_both_of(Vec a, Vec b, Vec c) { return vfmsq_f64(vnegq_f64(c), a, b); }
inline Vec square_root_of(Vec a) { return vsqrtq_f64(a); }
inline Vec absolute_of(Vec a) { return vabsq_f64(a); }
inline Vec floor_of(Vec a) { return vrndmq_f64(a); }
inline Mask not_of(Mask a) { return veorq_u64(a, vdupq_n_u64(~0ULL)); }
inline Mask is_number(Vec a) { return vceqq_f64(a, a); }
inline Mask has_order(Vec a, Vec b) { return vandq_u64(is_number(a), is_number(b)); }
inline Mask is_zero(Vec a) { return vceqq_f64(a, zero()); }
inline Mask is_true(Vec a) { return vandq_u64(is_number(a), not_of(is_zero(a))); }
inline Vec with_nan_of(Vec result, Vec a) { return vbslq_f64(is_number(a), result, a); }
// Not vminq and vmaxq, which order zeros by their signs and return any NaN.
inline Vec minimum_of(Vec a, Vec b) { return with_nan_of(vbslq_f64(vcltq_f64(a, b), a, b), a); }
inline Vec maximum_of(Vec a, Vec b) { return with_nan_of(vbslq_f64(vcgtq_f64(a, b), a, b), a); }
inline Vec condition(Mask mask) { return vbslq_f64(mask, one(), zero()); }
// Where operands have no order, a comparison leaves a NaN.
inline Vec compared(Vec a, Vec b, Mask mask) { return vbslq_f64(has_order(a, b), condition(mask), vdupq_n_f64(__builtin_nan(""))); }
inline Vec less_of(Vec a, Vec b) { return compared(a, b, vcltq_f64(a, b)); }
inline Vec less_equal_of(Vec a, Vec b) { return compared(a, b, vcleq_f64(a, b)); }
inline Vec equal_of(Vec a, Vec b) { return compared(a, b, vceqq_f64(a, b)); }
inline Vec both_of(Vec a, Vec b) {
  Mask const false_one = vorrq_u64(is_zero(a), is_zero(b));
  return vbslq_f64(false_one, zero(), compared(a, b, vdupq_n_u64(~0ULL)));
}
inline Vec either_of(Vec a, Vec b) {
  Mask const true_one = vorrq_u64(is_true(a), is_true(b));
  return vbslq_f64(true_one, one(), compared(a, b, vdupq_n_u64(0)));
}
inline Vec select_of(Vec a, Vec b, Vec c) { return with_nan_of(vbslq_f64(is_zero(a), c, b), a); }

#include "program/interpreter/lanes_handlers.hpp"

}  // namespace

#include "program/interpreter/lanes_offered.hpp"

}  // namespace sysid::neon
