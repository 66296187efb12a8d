#include "discovery/search/record_noise.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>

#include "core/numeric/random.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

std::vector<double> motion() {
  std::vector<double> all;
  for (int i = 0; i < 300; ++i) all.push_back(4 * std::sin(0.1 * i) * std::exp(-0.005 * i));
  return all;
}

}  // namespace

TEST_CASE("the rounding of a record is read off its digits, significant ones or decimals") {
  for (char const* form : {"{:.7g}", "{:.3g}", "{:.4f}", "{:.2e}"}) {
    CAPTURE(form);
    std::vector<double> written;
    double squares = 0;
    for (double const y : motion()) {
      written.push_back(std::stod(fmt::format(fmt::runtime(form), y)));
      squares += std::pow(written.back() - y, 2);
    }
    // The mean of 300 squares of uniform errors lies within 16 % of its expectation, three sds.
    CHECK(rounding_sd(written) == relative(std::sqrt(squares / 300), 0.16));
  }
  std::vector<double> const sds = rounding_sds(std::vector<double>{1.23, -12.3, 0, std::nan(""), 0.456});
  std::vector<double> const places = {0.01, 0.1, 0, 0, 0.001};
  for (std::size_t i = 0; i < places.size(); ++i) CHECK(sds[i] == relative(places[i] / std::sqrt(12.0), 1e-12));
  CHECK(rounding_sd(motion()) == 0);
  CHECK(rounding_sd(std::vector<double>{0, std::nan(""), 0}) == 0);
}

TEST_CASE("an input of set levels has no rounding error, one that was measured and rounded has") {
  Stream stream({4, Purpose::test, 0, 0});
  std::vector<double> switched, stairs, measured, slow;
  double level = 0;
  for (int i = 0; i < 400; ++i) {
    switched.push_back(stream.uniform() < 0.5 ? 0.3 : -0.3);
    if (i % 4 == 0) level = std::round(100 * stream.normal()) / 100;
    stairs.push_back(level);
    measured.push_back(std::round(100 * stream.normal()) / 100);
    slow.push_back(std::round(100 * std::sin(0.01 * i)) / 100);
  }
  std::vector<double> coarse, spread;
  for (int i = 0; i < 400; ++i) {
    coarse.push_back(std::round(9 * std::sin(0.3 * i)) / 10);  // 19 values, a measured sine
    spread.push_back(std::round(4 * stream.normal()) * 2.5);
  }
  CHECK_FALSE(are_levels(coarse));
  CHECK(are_levels(spread));
  CHECK(are_levels(switched));
  CHECK(are_levels(stairs));
  CHECK_FALSE(are_levels(measured));
  CHECK_FALSE(are_levels(slow));
  CHECK_FALSE(are_levels(motion()));
}

TEST_CASE("noise in proportion to the signal is told from noise that is alike in all samples") {
  std::vector<double> const signal = motion();
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    Stream stream({seed, Purpose::noise, 0, 0});
    std::vector<double> proportional, alike;
    for (double const y : signal) {
      double const error = stream.normal();
      proportional.push_back(0.05 * y * error);
      alike.push_back(0.1 * error);
    }
    auto const grows = growing_noise(signal, proportional);
    REQUIRE(grows);
    CHECK(grows->gain > 20);
    double squares = 0;
    for (double const each : grows->relative) squares += each * each;
    CHECK(squares / 300 == doctest::Approx(1));
    CHECK(grows->relative[15] > 3 * grows->relative[0]);
    CHECK_FALSE(growing_noise(signal, alike));
  }
}
