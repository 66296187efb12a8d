// What a record itself says of its noise: the digits that its samples were written with, and whether noise grows with the signal.
#pragma once
#include <optional>
#include <span>
#include <vector>

namespace sysid {

/// The sd of rounding of each sample, where samples were written with a fixed number of significant digits or of decimals: the unit
/// of the last place over sqrt(12). 0 where they carry all digits of a double, and of samples that are 0 or missing.
std::vector<double> rounding_sds(std::span<double const> samples);
/// The root mean square of these, over samples that are neither 0 nor missing.
double rounding_sd(std::span<double const> samples);

/// Whether samples are levels that were set, as of a switch, so that the digits they lack are zeros: of at most four values, of at
/// most 32 that are seldom neighbours in the last place, or of values that mostly stay for several samples and then change by more
/// than its unit. What was measured and rounded wanders from one value to its neighbours.
bool are_levels(std::span<double const> samples);

/// Noise of a channel whose sd is in proportion to sqrt(signal^2 + offset^2).
struct GrowingNoise {
  double offset = 0;             // in the unit of the signal
  double gain = 0;               // of log likelihood over noise that is alike in all samples
  std::vector<double> relative;  // per sample; root mean square 1
};

/// By likelihood over a few offsets, from root mean squares of the signal down to a sixteenth; nothing where constant noise is as
/// likely, its gain less than log n. signal, residual: of the measured samples.
std::optional<GrowingNoise> growing_noise(std::span<double const> signal, std::span<double const> residual);

}  // namespace sysid
