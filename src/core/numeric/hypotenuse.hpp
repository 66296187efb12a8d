// sqrt(a^2 + b^2) with the same bytes on every processor. That of the C library fuses where its build for a processor may.
#pragma once
#include <cmath>

namespace sysid {

/// Not for squares beyond the range of numbers.
inline double hypotenuse(double a, double b) { return std::sqrt(a * a + b * b); }

}  // namespace sysid
