// Discrete Fourier transforms for autocovariances. Ours, because library transforms take their factors from the C library's sine,
// whose last digit depends on the processor.
#pragma once
#include <cstddef>
#include <vector>

namespace sysid {

/// Transforms of one power-of-two length of at least 4, real and imaginary parts apart, in place and unscaled.
class Fourier {
 public:
  using Parts = std::vector<double>;

  explicit Fourier(std::size_t size);
  std::size_t size() const { return size_; }

  /// sum_t x_t exp(-2 pi i k t / N), from natural order to bit-reversed order.
  void to_reversed(Parts& re, Parts& im) const;
  /// The same sum, from bit-reversed order to natural order.
  void from_reversed(Parts& re, Parts& im) const;

 private:
  std::size_t size_;
  Parts cosine_, sine_;  // the factors of the stage with blocks of 2 h stand at h .. 2 h - 1
};

}  // namespace sysid
