// The spectrum of a record: its bandwidth and its dominant period.
#pragma once
#include <span>
#include <vector>

namespace sysid::regression {

/// Mean squares about the mean by frequency, under a Hann taper, missing samples bridged by straight lines; white noise of sd s has
/// 2 s^2/size at each.
struct Spectrum {
  std::vector<double> power;  // at k/length, k = 0, 1, ...; empty for a constant
  std::size_t size = 0;       // samples, zeros behind the record counted
  double length = 0;          // [s], the record's with zeros behind it
};
/// samples: [N], equal steps [s].
Spectrum spectrum_of(std::span<double const> samples, double step);

/// The period [s] at which the power of several signals, each as a part of its own total, is greatest, of those that the longest
/// record holds three times; 0 when there is none.
double dominant_period(std::span<std::vector<double> const> signals, double step);

}  // namespace sysid::regression
