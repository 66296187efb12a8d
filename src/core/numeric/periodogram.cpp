// By the Fourier transform of a power of two.
#include "core/numeric/periodogram.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <numbers>

#include "core/numeric/elementary.hpp"

namespace sysid {

void taper(std::vector<double>& samples) {
  auto const n = static_cast<double>(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples[i] *= 1 - elementary::cos(2 * std::numbers::pi * (static_cast<double>(i) + 0.5) / n);
}

std::vector<double> periodogram(std::vector<double> samples, Fourier::Between between) {
  std::size_t const size = std::bit_ceil(std::max<std::size_t>(samples.size(), 4));
  samples.resize(size, 0.0);
  Fourier::Parts imaginary(size, 0.0);
  Fourier(size, between).to_reversed(samples, imaginary, between);
  int const bits = std::countr_zero(size);
  std::vector<double> power(size / 2 + 1);
  for (std::size_t k = 0; k < power.size(); ++k) {
    std::size_t reversed = 0;
    for (int b = 0; b < bits; ++b) reversed |= ((k >> b) & 1U) << (bits - 1 - b);
    power[k] = samples[reversed] * samples[reversed] + imaginary[reversed] * imaginary[reversed];
  }
  return power;
}

}  // namespace sysid
