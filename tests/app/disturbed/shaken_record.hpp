// The record of an oscillator that is shaken by a force that was measured and by one that was not.
#pragma once
#include <fmt/format.h>

#include <cstdint>
#include <string>

#include "core/numeric/random.hpp"

namespace sysid::testing {

/// t,x,y of m y'' + c y' + k y = x + w with m = 1 kg, c = 1 N s/m, k = 400 N/m, from rest, at 100 Hz; x has sd 1 N and w sd
/// `unmeasured`, both held between samples; cubic y^3 is added on the left; the sensor's noise has sd 2e-5 m. Integrated with 50
/// steps between samples.
inline std::string shaken_record(std::uint64_t seed, double unmeasured, int samples, double cubic = 0) {
  Stream stream({seed, Purpose::test});
  constexpr int fine = 50;
  double const rate = 100, step = 1 / rate / fine, m = 1, c = 1, k = 400;
  double y = 0, v = 0;
  std::string text = "t,x,y\n";
  for (int i = 0; i < samples; ++i) {
    double const x = stream.normal(), w = unmeasured * stream.normal();
    text += fmt::format("{},{},{}\n", i / rate, x, y + 2e-5 * stream.normal());
    for (int j = 0; j < fine; ++j) {
      v += step * (x + w - c * v - k * y - cubic * y * y * y) / m;
      y += step * v;
    }
  }
  return text;
}

}  // namespace sysid::testing
