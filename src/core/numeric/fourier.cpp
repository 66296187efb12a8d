// Radix-2 transforms by decimation in frequency and in time.
#include "core/numeric/fourier.hpp"

#include <algorithm>
#include <bit>
#include <numbers>

#include "core/numeric/elementary.hpp"

namespace sysid {

namespace {

/// Every quarter of a million steps of a loop, which take some hundredths of a second.
void pause(Fourier::Between between, std::size_t step) {
  constexpr std::size_t often = std::size_t{1} << 18;
  if (between != nullptr && step % often == 0) between();
}

}  // namespace

Fourier::Fourier(std::size_t size, Between between) : size_(size), cosine_(size), sine_(size) {
  for (std::size_t k = 0; k < size / 2; ++k) {
    pause(between, k);
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

void Fourier::to_reversed(Parts& re, Parts& im, Between between) const {
  for (long half = static_cast<long>(size_) / 2; half > 0; half /= 2) {
    if (between != nullptr) between();
    fourier_stages::in_frequency(at(re, im), half);
  }
}

void Fourier::from_reversed(Parts& re, Parts& im, Between between) const {
  for (long half = 1; half < static_cast<long>(size_); half *= 2) {
    if (between != nullptr) between();
    fourier_stages::in_time(at(re, im), half);
  }
}

fourier_stages::Points Fourier::at(Parts& re, Parts& im) const {
  return {re.data(), im.data(), static_cast<long>(size_), cosine_.data(), sine_.data()};
}

namespace {

/// Of the circular convolution that replaces a transform of N points.
std::size_t convolution_size(std::size_t size) { return std::max<std::size_t>(4, std::bit_ceil(2 * size)); }

}  // namespace

/// Bluestein's algorithm: k t = (k^2 + t^2 - (t - k)^2)/2 makes the sum a convolution with a chirp, w_n = exp(pi i n^2/N):
///
///   x_t = w_t sum_k (X_k w_k) conj(w_{t-k})                                            Bluestein 1970; Rabiner et al. 1969
///
/// n^2 is reduced modulo 2 N in whole numbers, so that long records lose nothing.
void add_harmonics(Fourier::Parts& re, Fourier::Parts& im, Fourier::Between between) {
  std::size_t const size = re.size(), padded = convolution_size(size);
  if (size == 0) return;
  Fourier const fourier(padded, between);
  Fourier::Parts chirp_re(size), chirp_im(size), a_re(padded), a_im(padded), b_re(padded), b_im(padded);
  for (std::size_t n = 0; n < size; ++n) {
    pause(between, n);
    double const angle = std::numbers::pi * static_cast<double>(n * n % (2 * size)) / static_cast<double>(size);
    chirp_re[n] = elementary::cos(angle);
    chirp_im[n] = elementary::sin(angle);
    a_re[n] = re[n] * chirp_re[n] - im[n] * chirp_im[n];
    a_im[n] = re[n] * chirp_im[n] + im[n] * chirp_re[n];
    std::size_t const mirrored = (padded - n) % padded;
    b_re[n] = b_re[mirrored] = chirp_re[n];
    b_im[n] = b_im[mirrored] = -chirp_im[n];
  }
  fourier.to_reversed(a_re, a_im, between);
  fourier.to_reversed(b_re, b_im, between);
  // The inverse transform is the transform of the conjugates, conjugated.
  for (std::size_t i = 0; i < padded; ++i) {
    pause(between, i);
    double const product_re = a_re[i] * b_re[i] - a_im[i] * b_im[i], product_im = a_re[i] * b_im[i] + a_im[i] * b_re[i];
    a_re[i] = product_re;
    a_im[i] = -product_im;
  }
  fourier.from_reversed(a_re, a_im, between);
  for (std::size_t t = 0; t < size; ++t) {
    pause(between, t);
    double const sum_re = a_re[t] / static_cast<double>(padded), sum_im = -a_im[t] / static_cast<double>(padded);
    re[t] = sum_re * chirp_re[t] - sum_im * chirp_im[t];
    im[t] = sum_re * chirp_im[t] + sum_im * chirp_re[t];
  }
}

double bytes_to_add_harmonics(std::size_t size) {
  return sizeof(double) * (6.0 * static_cast<double>(convolution_size(size)) + 2.0 * static_cast<double>(size));
}

}  // namespace sysid
