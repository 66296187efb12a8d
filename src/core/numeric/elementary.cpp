// Elementary functions: the scalar form, and the choice of vector form for lanes; what does not fill a vector goes through the
// scalar form.
#include "core/numeric/elementary.hpp"

#include "core/numeric/elementary_vector.hpp"
#include "core/numeric/instruction_set.hpp"

#define SYSID_UNARY(name, accuracy) extern "C" double Sleef_finz_##name##d1_##accuracy##purecfma(double);
#define SYSID_BINARY(name, accuracy) extern "C" double Sleef_finz_##name##d1_##accuracy##purecfma(double, double);
SYSID_ELEMENTARY_UNARY(SYSID_UNARY)
SYSID_ELEMENTARY_BINARY(SYSID_BINARY)
#undef SYSID_UNARY
#undef SYSID_BINARY

namespace sysid::elementary {
namespace {

/// Lanes [0, wide) go through 512-bit vectors, [wide, narrow) through those of the narrow set, the rest one by one.
struct Division {
  explicit Division(int width)
      : wide(instruction_set() == InstructionSet::avx512 ? width - width % 8 : 0),
        narrow(width - width % vector_lanes(narrowest_instruction_set)) {}
  int wide, narrow;
};

}  // namespace

#define SYSID_UNARY(name, accuracy)                                                             \
  double name(double x) { return Sleef_finz_##name##d1_##accuracy##purecfma(x); }               \
  void name##_lanes(double const* x, double* out, int width) {                                  \
    Division const to(width);                                                                   \
    if (to.wide > 0) wide_set::name(x, out, to.wide);                                           \
    if (to.narrow > to.wide) narrow_set::name(x + to.wide, out + to.wide, to.narrow - to.wide); \
    for (int i = to.narrow; i < width; ++i) out[i] = name(x[i]);                                \
  }
#define SYSID_BINARY(name, accuracy)                                                                         \
  double name(double x, double y) { return Sleef_finz_##name##d1_##accuracy##purecfma(x, y); }               \
  void name##_lanes(double const* x, double const* y, double* out, int width) {                              \
    Division const to(width);                                                                                \
    if (to.wide > 0) wide_set::name(x, y, out, to.wide);                                                     \
    if (to.narrow > to.wide) narrow_set::name(x + to.wide, y + to.wide, out + to.wide, to.narrow - to.wide); \
    for (int i = to.narrow; i < width; ++i) out[i] = name(x[i], y[i]);                                       \
  }
SYSID_ELEMENTARY_UNARY(SYSID_UNARY)
SYSID_ELEMENTARY_BINARY(SYSID_BINARY)
#undef SYSID_UNARY
#undef SYSID_BINARY

void const* vector_form(void const* lanes, bool wide) {
#define SYSID_FORM(name, accuracy) \
  if (lanes == reinterpret_cast<void const*>(&name##_lanes)) return wide ? wide_set::name##_form() : narrow_set::name##_form();
  SYSID_ELEMENTARY_UNARY(SYSID_FORM)
  SYSID_ELEMENTARY_BINARY(SYSID_FORM)
#undef SYSID_FORM
  return nullptr;
}

}  // namespace sysid::elementary
