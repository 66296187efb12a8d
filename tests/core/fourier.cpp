// The transform against its defining sum.
#include "core/numeric/fourier.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <cmath>
#include <numbers>

#include "core/numeric/random.hpp"

using namespace sysid;

TEST_CASE("both transforms are the defining sum, up to the order of their ends") {
  for (std::size_t const n : {4U, 8U, 16U, 32U, 64U, 128U}) {
    Fourier const fourier(n);
    Stream stream({1, Purpose::test, n, 0});
    std::vector<double> re(n), im(n), sum_re(n, 0.0), sum_im(n, 0.0), reversed_re(n), reversed_im(n);
    for (std::size_t t = 0; t < n; ++t) {
      re[t] = stream.normal();
      im[t] = stream.normal();
    }
    auto const reversed = [n](std::size_t k) {
      std::size_t r = 0;
      for (std::size_t bit = 1; bit < n; bit *= 2) r = 2 * r + (k & bit ? 1 : 0);
      return r;
    };
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t t = 0; t < n; ++t) {
        double const angle = -2 * std::numbers::pi * static_cast<double>(k * t % n) / static_cast<double>(n);
        sum_re[k] += re[t] * std::cos(angle) - im[t] * std::sin(angle);
        sum_im[k] += re[t] * std::sin(angle) + im[t] * std::cos(angle);
      }
      reversed_re[k] = re[reversed(k)];
      reversed_im[k] = im[reversed(k)];
    }
    fourier.to_reversed(re, im);
    fourier.from_reversed(reversed_re, reversed_im);
    // Rounding: a few units of 1e-16 per stage on sums of size sqrt(n).
    for (std::size_t k = 0; k < n; ++k) {
      CHECK(std::fabs(re[reversed(k)] - sum_re[k]) < 1e-13);
      CHECK(std::fabs(im[reversed(k)] - sum_im[k]) < 1e-13);
      CHECK(std::fabs(reversed_re[k] - sum_re[k]) < 1e-13);
      CHECK(std::fabs(reversed_im[k] - sum_im[k]) < 1e-13);
    }
  }
}

TEST_CASE("harmonics of a record of any length add up to the defining sum") {
  for (std::size_t const n : {1U, 2U, 3U, 12U, 97U, 128U, 1000U}) {
    CAPTURE(n);
    Stream stream({1, Purpose::test, n, 1});
    std::vector<double> re(n), im(n);
    for (std::size_t k = 0; k < n; ++k) {
      re[k] = stream.normal();
      im[k] = stream.normal();
    }
    std::vector<double> sum_re(n, 0.0), sum_im(n, 0.0);
    for (std::size_t t = 0; t < n; ++t)
      for (std::size_t k = 0; k < n; ++k) {
        double const angle = 2 * std::numbers::pi * static_cast<double>(k * t % n) / static_cast<double>(n);
        sum_re[t] += re[k] * std::cos(angle) - im[k] * std::sin(angle);
        sum_im[t] += re[k] * std::sin(angle) + im[k] * std::cos(angle);
      }
    add_harmonics(re, im);
    // Sums of size sqrt(n) through three transforms of 2 n points.
    double const tolerance = 1e-14 * static_cast<double>(n + 10);
    for (std::size_t t = 0; t < n; ++t) {
      CHECK(std::fabs(re[t] - sum_re[t]) < tolerance);
      CHECK(std::fabs(im[t] - sum_im[t]) < tolerance);
    }
  }
}

TEST_CASE("a million harmonics, of a length that is prime, take seconds: a sum over pairs would take hours") {
  constexpr std::size_t n = 1'000'003;
  std::vector<double> re(n, 0.0), im(n, 0.0);
  re[1] = 1;
  auto const begin = std::chrono::steady_clock::now();
  add_harmonics(re, im);
  CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(60));
  CHECK(re[n / 2] == doctest::Approx(-1).epsilon(1e-9));
}
