// What a record itself says of its noise: the digits that its samples were written with, and whether noise grows with the signal.
#pragma once
#include <optional>
#include <span>
#include <vector>

namespace sysid {

/// The sd of rounding of samples that were written with a fixed number of significant digits or of decimals (the unit of the last
/// place over sqrt(12), root mean square); 0 where they carry all digits of a double.
double rounding_sd(std::span<double const> samples);

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
