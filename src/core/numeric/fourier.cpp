// Radix-2 transforms by decimation in frequency and in time.
#include "core/numeric/fourier.hpp"

#include <bit>
#include <numbers>

#include "core/numeric/elementary.hpp"

namespace sysid {

Fourier::Fourier(std::size_t size) : size_(size), cosine_(size), sine_(size) {
  for (std::size_t k = 0; k < size / 2; ++k) {
    double const angle = -2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(size);
    cosine_[size / 2 + k] = elementary::cos(angle);
    sine_[size / 2 + k] = elementary::sin(angle);
  }
  for (std::size_t i = size / 2 - 1; i > 0; --i) {
    std::size_t const half = std::bit_floor(i), k = i - half;
    cosine_[i] = cosine_[2 * half + 2 * k];
    sine_[i] = sine_[2 * half + 2 * k];
  }
}

void Fourier::to_reversed(Parts& re, Parts& im) const {
  for (std::size_t half = size_ / 2; half > 0; half /= 2) {
    double const *const c = &cosine_[half], *const s = &sine_[half];
    for (std::size_t start = 0; start < size_; start += 2 * half) {
      double *const ar = &re[start], *const ai = &im[start], *const br = ar + half, *const bi = ai + half;
      for (std::size_t k = 0; k < half; ++k) {
        double const dr = ar[k] - br[k], di = ai[k] - bi[k];
        ar[k] += br[k];
        ai[k] += bi[k];
        br[k] = dr * c[k] - di * s[k];
        bi[k] = dr * s[k] + di * c[k];
      }
    }
  }
}

void Fourier::from_reversed(Parts& re, Parts& im) const {
  for (std::size_t half = 1; half < size_; half *= 2) {
    double const *const c = &cosine_[half], *const s = &sine_[half];
    for (std::size_t start = 0; start < size_; start += 2 * half) {
      double *const ar = &re[start], *const ai = &im[start], *const br = ar + half, *const bi = ai + half;
      for (std::size_t k = 0; k < half; ++k) {
        double const tr = br[k] * c[k] - bi[k] * s[k], ti = br[k] * s[k] + bi[k] * c[k];
        br[k] = ar[k] - tr;
        bi[k] = ai[k] - ti;
        ar[k] += tr;
        ai[k] += ti;
      }
    }
  }
}

}  // namespace sysid
