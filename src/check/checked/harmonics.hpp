// Which multiples of rate/samples a multisine consists of: for the checker, which refuses one without any, and for the run.
#pragma once
#include <algorithm>
#include <cmath>

namespace sysid {

/// k/(samples step) for k from `first` to `last`; none where `last` is less.
struct HarmonicRange {
  int first = 1, last = 0;
  bool empty() const { return last < first; }
};

/// At or above half the rate a sine is, at the samples, one of a lower frequency. Rounding does not decide: half the rate counts.
inline bool beyond_half_rate(double frequency, double step) { return frequency * step >= 0.5 * (1 - 1e-9); }

/// lowest, highest: [Hz]; step: [s]. Those on a limit of the band are in it, whatever the rounding: 3 * 0.1 is more than 0.3.
inline HarmonicRange harmonics_in_band(double lowest, double highest, int samples, double step) {
  constexpr double rounding = 1e-9;
  int const below_half = (samples - 1) / 2;
  double const seconds = samples * step, most = below_half;
  double const last = std::min(std::floor(highest * seconds * (1 + rounding)), most);
  double const first = std::clamp(std::ceil(lowest * seconds * (1 - rounding)), 1.0, most + 1);
  return {static_cast<int>(first), static_cast<int>(last)};
}

}  // namespace sysid
