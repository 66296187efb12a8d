// Discrete Fourier transforms for autocovariances and made signals. Ours, because library transforms take their factors from the C
// library's sine, whose last digit depends on the processor.
#pragma once
#include <cstddef>
#include <vector>

#include "core/numeric/fourier_stages.hpp"

namespace sysid {

/// Transforms of one power-of-two length of at least 4, real and imaginary parts apart, in place and unscaled.
class Fourier {
 public:
  using Parts = std::vector<double>;
  using Between = void (*)();

  /// between: called now and then while the factors are made.
  explicit Fourier(std::size_t size, Between between = nullptr);
  std::size_t size() const { return size_; }

  /// sum_t x_t exp(-2 pi i k t / N), from natural order to bit-reversed order.
  /// between: called between stages, of which each takes a time proportional to N.
  void to_reversed(Parts& re, Parts& im, Between between = nullptr) const;
  /// The same sum, from bit-reversed order to natural order.
  void from_reversed(Parts& re, Parts& im, Between between = nullptr) const;

 private:
  fourier_stages::Points at(Parts& re, Parts& im) const;

  std::size_t size_;
  Parts cosine_, sine_;  // the factors of the stage with blocks of 2 h stand at h .. 2 h - 1
};

/// x_t = sum_k X_k exp(2 pi i k t / N) in place of X, for any length N of both parts, in a time proportional to N log N.
void add_harmonics(Fourier::Parts& re, Fourier::Parts& im, Fourier::Between between = nullptr);

/// Bytes that it takes beside its arguments.
double bytes_to_add_harmonics(std::size_t size);

}  // namespace sysid
