// Powers against the defining sum, and the window.
#include "core/numeric/periodogram.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "core/numeric/random.hpp"
#include "relative.hpp"

using namespace sysid;

TEST_CASE("powers are those of the defining sum, zeros behind the samples") {
  Stream stream({1, Purpose::test, 0, 0});
  for (std::size_t const n : {1U, 3U, 4U, 5U, 16U, 100U}) {
    CAPTURE(n);
    std::vector<double> samples(n);
    for (double& each : samples) each = stream.normal();
    std::vector<double> const power = periodogram(samples);
    std::size_t const size = 2 * (power.size() - 1);
    REQUIRE(size >= std::max<std::size_t>(n, 4));
    CHECK((size & (size - 1)) == 0);
    for (std::size_t k = 0; k < power.size(); ++k) {
      std::complex<double> sum = 0;
      for (std::size_t t = 0; t < n; ++t)
        sum += samples[t] * std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(k * t) / static_cast<double>(size));
      CHECK(power[k] == relative(std::norm(sum), 1e-10));
    }
  }
}

TEST_CASE("under the window the power of a tone lies about its frequency, wherever that is") {
  for (double const frequency : {10.0, 10.25, 10.5}) {  // of 100 samples, periods
    std::vector<double> samples(100), bare(100);
    for (std::size_t i = 0; i < 100; ++i)
      bare[i] = samples[i] = std::cos(2 * std::numbers::pi * frequency * static_cast<double>(i) / 100);
    taper(samples);
    auto const outside = [&](std::vector<double> const& of) {
      std::vector<double> const power = periodogram(of);
      double all = 0, far = 0;
      for (std::size_t k = 0; k < power.size(); ++k) {
        all += power[k];
        if (std::fabs(static_cast<double>(k) * 100 / 128 - frequency) > 3) far += power[k];
      }
      return far / all;
    };
    CHECK(outside(samples) < 1e-3);
    CHECK(outside(bare) > 1e-2);
  }
}
