// Elementary functions over whole vectors: provided by the files for one instruction set, called by elementary.cpp.
#pragma once

#include "core/numeric/elementary_list.hpp"

namespace sysid::elementary {

/// Beside each, the address of the function of one vector behind it.
#define SYSID_UNARY(name, accuracy)                   \
  void name(double const* x, double* out, int width); \
  void const* name##_form();
#define SYSID_BINARY(name, accuracy)                                   \
  void name(double const* x, double const* y, double* out, int width); \
  void const* name##_form();
#if defined(__aarch64__)
namespace neon {  // width: a multiple of 2
SYSID_ELEMENTARY_UNARY(SYSID_UNARY)
SYSID_ELEMENTARY_BINARY(SYSID_BINARY)
}  // namespace neon
namespace narrow_set = neon;
namespace wide_set = neon;
#else
namespace avx2 {  // width: a multiple of 4
SYSID_ELEMENTARY_UNARY(SYSID_UNARY)
SYSID_ELEMENTARY_BINARY(SYSID_BINARY)
}  // namespace avx2
namespace avx512 {  // width: a multiple of 8
SYSID_ELEMENTARY_UNARY(SYSID_UNARY)
SYSID_ELEMENTARY_BINARY(SYSID_BINARY)
}  // namespace avx512
namespace narrow_set = avx2;
namespace wide_set = avx512;
#endif
#undef SYSID_UNARY
#undef SYSID_BINARY

}  // namespace sysid::elementary
