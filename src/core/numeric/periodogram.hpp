// Power by frequency.
#pragma once
#include <vector>

#include "core/numeric/fourier.hpp"

namespace sysid {

/// Multiplies by Hann's window, whose mean square is 1.5: under it the jump from the last sample to the first is no power.
void taper(std::vector<double>& samples);

/// |sum_t x_t exp(-2 pi i k t / size)|^2 at k = 0 .. size/2 of samples padded with zeros to `size` (2 less than twice the length of
/// the result), a power of two of at least 4.
/// between: called now and then.
std::vector<double> periodogram(std::vector<double> samples, Fourier::Between between = nullptr);

}  // namespace sysid
