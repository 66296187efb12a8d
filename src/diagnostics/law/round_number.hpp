// Round numbers, for parameters and priors that a help proposes.
#pragma once
#include <cmath>

namespace sysid {

/// 1, 2 or 5 times a power of ten, not below `value` > 0.
inline double round_number_above(double value) {
  double const power = std::pow(10.0, std::floor(std::log10(value)));
  for (double const digit : {1.0, 2.0, 5.0})
    if (digit * power >= value) return digit * power;
  return 10 * power;
}

}  // namespace sysid
