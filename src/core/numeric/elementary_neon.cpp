// Elementary functions over vectors of 2 lanes (compiled for AArch64, see CMakeLists.txt): SLEEF's deterministic family.
#include <arm_neon.h>

#include "core/numeric/elementary_vector.hpp"

#define SYSID_UNARY(name, accuracy) extern "C" float64x2_t Sleef_finz_##name##d2_##accuracy##advsimd(float64x2_t);
#define SYSID_BINARY(name, accuracy) extern "C" float64x2_t Sleef_finz_##name##d2_##accuracy##advsimd(float64x2_t, float64x2_t);
SYSID_ELEMENTARY_UNARY(SYSID_UNARY)
SYSID_ELEMENTARY_BINARY(SYSID_BINARY)
#undef SYSID_UNARY
#undef SYSID_BINARY

namespace sysid::elementary::neon {

#define SYSID_UNARY(name, accuracy)                                                                                     \
  void name(double const* x, double* out, int width) {                                                                  \
    for (int i = 0; i < width; i += 2) vst1q_f64(out + i, Sleef_finz_##name##d2_##accuracy##advsimd(vld1q_f64(x + i))); \
  }
#define SYSID_BINARY(name, accuracy)                                                                     \
  void name(double const* x, double const* y, double* out, int width) {                                  \
    for (int i = 0; i < width; i += 2)                                                                   \
      vst1q_f64(out + i, Sleef_finz_##name##d2_##accuracy##advsimd(vld1q_f64(x + i), vld1q_f64(y + i))); \
  }
SYSID_ELEMENTARY_UNARY(SYSID_UNARY)
SYSID_ELEMENTARY_BINARY(SYSID_BINARY)
#undef SYSID_UNARY
#undef SYSID_BINARY

#define SYSID_FORM(name, accuracy) \
  void const* name##_form() { return reinterpret_cast<void const*>(&Sleef_finz_##name##d2_##accuracy##advsimd); }
SYSID_ELEMENTARY_UNARY(SYSID_FORM)
SYSID_ELEMENTARY_BINARY(SYSID_FORM)
#undef SYSID_FORM

}  // namespace sysid::elementary::neon
