// Numbers that are as near to each other as a share of their size, however small they are.
#pragma once
#include <doctest/doctest.h>

#include <limits>

namespace sysid {

/// doctest::Approx alone adds 1 to the size: of what is far below 1, its tolerance is an absolute one, and anything passes. Nothing
/// but 0 is like 0.
inline doctest::Approx relative(double value, double tolerance) {
  return doctest::Approx(value).epsilon(tolerance).scale(std::numeric_limits<double>::min());
}

}  // namespace sysid
