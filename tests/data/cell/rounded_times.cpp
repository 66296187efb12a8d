// Times of equal steps as files hold them, and times that only look like it.
#include "data/cell/rounded_times.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <string>

#include "relative.hpp"

using namespace sysid;

namespace {

/// begin + i step, as printed with these significant digits.
std::vector<double> printed(double begin, double step, int count, int digits) {
  std::vector<double> time;
  for (int i = 0; i < count; ++i) time.push_back(std::stod(fmt::format("{:.{}g}", begin + i * step, digits)));
  return time;
}

}  // namespace

TEST_CASE("equal steps are found again behind the digits of the file") {
  for (double const begin : {0.0, 17.3})
    for (double const length : {1.2, 7.0, 350.0}) {
      double const step = length / 149;
      auto const equal = equal_times_before_rounding(printed(begin, step, 150, 7));
      REQUIRE(equal);
      double const unit = begin + length < 10 ? 1e-6 : begin + length < 100 ? 1e-5 : 1e-4;
      for (std::size_t i = 0; i < 150; ++i) CHECK(std::abs((*equal)[i] - begin - static_cast<double>(i) * step) < unit);
      CHECK((*equal)[1] - (*equal)[0] == relative(step, unit / length));
    }
}

TEST_CASE("digits behind the point count as well as significant ones") {
  // 29.97 frames a second, milliseconds.
  std::vector<double> time;
  for (int i = 0; i < 300; ++i) time.push_back(std::round(i / 29.97 * 1e3) / 1e3);
  auto const equal = equal_times_before_rounding(time);
  REQUIRE(equal);
  CHECK((*equal)[299] == doctest::Approx(299 / 29.97).epsilon(1e-5));
}

TEST_CASE("one time that is two units off is not rounding") {
  std::vector<double> time = printed(0, 7.0 / 149, 150, 7);
  time[70] += 2e-6;
  CHECK_FALSE(equal_times_before_rounding(time));
}

TEST_CASE("of few digits nothing is concluded") {
  CHECK_FALSE(equal_times_before_rounding(std::vector<double>{0, 1, 2, 4, 5, 6}));
  CHECK_FALSE(equal_times_before_rounding(std::vector<double>{0, 0.1, 0.3, 0.4, 0.5}));
  CHECK_FALSE(equal_times_before_rounding(std::vector<double>{0, 13, 25, 38}));
}

TEST_CASE("steps that grow are unequal, however many digits there are") {
  std::vector<double> time;
  for (int i = 0; i < 100; ++i) time.push_back(std::stod(fmt::format("{:.7g}", 0.03 * i + 1e-6 * i * i)));
  CHECK_FALSE(equal_times_before_rounding(time));
}

TEST_CASE("a clock that is a unit early or late now and then has not been rounded") {
  // 20 ms in milliseconds: off by 5 % of a step, which a model in discrete time does not take for equal.
  std::vector<double> time;
  for (int i = 0; i < 200; ++i) time.push_back((20.0 * i + (i % 7 == 3 ? 1 : i % 11 == 5 ? -1 : 0)) / 1e3);
  CHECK_FALSE(equal_times_before_rounding(time));
}

TEST_CASE("steps that are nearly whole units leave errors that grow, which are not a part of the step") {
  std::vector<double> time;
  for (int i = 0; i < 201; ++i) time.push_back(std::round(i * (26 + 0.75 / 200)) / 1e3);
  REQUIRE(equal_times_before_rounding(time));
}

TEST_CASE("equal steps of many lengths, rounded to one unit in 20 to 1000 steps, are found again") {
  for (double step = 0.0203; step < 1; step *= 1.37)
    for (double const begin : {0.0, 0.0004, 12.3457}) {
      std::vector<double> time;
      for (int i = 0; i < 400; ++i) time.push_back(std::round((begin + i * step) * 1e3) / 1e3);
      auto const equal = equal_times_before_rounding(time);
      REQUIRE(equal);
      CHECK(((*equal)[399] - (*equal)[0]) / 399 == relative(step, 1e-3 / (399 * step)));
    }
}

TEST_CASE("times of single precision were rounded, too, however they are written") {
  std::vector<double> whole, nine;
  for (int i = 0; i < 800; ++i) {
    double const single = static_cast<double>(static_cast<float>((3.7 + i) * 0.01));
    whole.push_back(single);
    nine.push_back(std::stod(fmt::format("{:.9g}", single)));
  }
  for (std::vector<double> const& time : {whole, nine}) {
    auto const equal = equal_times_before_rounding(time);
    REQUIRE(equal);
    CHECK(((*equal)[799] - (*equal)[0]) / 799 == relative(0.01, 1e-7));
  }
  whole[400] = static_cast<double>(static_cast<float>(whole[400] + 2e-6));  // four of its units
  CHECK_FALSE(equal_times_before_rounding(whole));
}

namespace {

/// i/rate from `begin` on, in whole numbers of `unit`, cut or rounded.
std::vector<double> in_units(double begin, double rate, int count, double unit, bool cut = false) {
  std::vector<double> time;
  for (int i = 0; i < count; ++i) {
    double const exact = (begin + i / rate) / unit;
    time.push_back(std::stod(fmt::format("{:.9g}", (cut ? std::floor(exact) : std::round(exact)) * unit)));
  }
  return time;
}

}  // namespace

TEST_CASE("steps of few units show their rate where there are enough of them") {
  for (auto const& [rate, unit] : {std::pair(256.0, 1e-3), std::pair(30.0, 1e-2), std::pair(44.1, 1e-2), std::pair(120.0, 1e-3),
                                   std::pair(3.3, 0.1), std::pair(400.0, 1e-3)})
    for (bool const cut : {false, true})
      for (double const begin : {0.0, 12.5}) {
        CAPTURE(rate);
        std::vector<double> const time = in_units(begin, rate, 3000, unit, cut);
        auto const found = rounded_steps(time, 1);
        REQUIRE(found);
        CHECK(found->rate == rate);
        CHECK(found->unit == relative(unit, 1e-12));
        CHECK(found->lower == relative(std::floor(1 / rate / unit) * unit, 1e-12));
      }
  // Milliseconds that are written as such.
  std::vector<double> milliseconds;
  for (int i = 0; i < 3000; ++i) milliseconds.push_back(12500 + std::round(i * 1000 / 256.0));
  auto const found = rounded_steps(milliseconds, 1e-3);
  REQUIRE(found);
  CHECK(found->rate == 256);
  CHECK(found->unit == relative(1e-3, 1e-12));
}

TEST_CASE("clocks that vary, few steps and equal ones are no rounding") {
  CHECK_FALSE(rounded_steps(in_units(0, 256, 40, 1e-3), 1));
  CHECK_FALSE(rounded_steps(in_units(0, 250, 3000, 1e-3), 1));
  CHECK_FALSE(rounded_steps(in_units(0, 700, 3000, 1e-3), 1));  // less than one and a half units
  std::vector<double> one_off = in_units(0, 256, 3000, 1e-3), at_random{0}, slow{0}, gap = one_off;
  one_off[1500] += 1e-3;
  CHECK_FALSE(rounded_steps(one_off, 1));
  gap.erase(gap.begin() + 700, gap.begin() + 720);
  CHECK_FALSE(rounded_steps(gap, 1));
  std::uint32_t state = 1;
  for (int i = 1; i < 400; ++i) {
    state = state * 1664525 + 1013904223;
    at_random.push_back(at_random.back() + (state >> 31U != 0 ? 3 : 4));
    slow.push_back(std::round(3.9 * i + 5e-4 * i * i));
  }
  CHECK_FALSE(rounded_steps(at_random, 1e-3));
  CHECK_FALSE(rounded_steps(slow, 1e-3));
}

TEST_CASE("steps are equal as the numbers stand, or before they were rounded") {
  std::vector<double> const as_they_stand = {0, 0.25, 0.5, 0.75, 1};
  CHECK(mean_step(as_they_stand) == 0.25);
  CHECK(unequal_step(as_they_stand) == 0);
  CHECK(has_equal_steps(as_they_stand));
  std::vector<double> const rounded = printed(0, 1.0 / 30, 300, 4);
  CHECK(unequal_step(rounded) > 0);
  CHECK(has_equal_steps(rounded));
  std::vector<double> const uneven = {0, 0.25, 0.5, 0.8, 1};
  CHECK(unequal_step(uneven) == 3);
  CHECK_FALSE(has_equal_steps(uneven));
}
