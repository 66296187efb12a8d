// Axes and script pieces.
#include "report/figure/plot.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace sysid;
using namespace sysid::plot;

TEST_CASE("ticks are round numbers inside the range, with equal digits") {
  Axis const a = axis(0.9983, 1.0021, 4);
  REQUIRE(a.ticks.size() == 4);
  CHECK(a.ticks[0].second == "0.999");
  CHECK(a.ticks[3].second == "1.002");
  CHECK(a.exponent == 0);
  for (auto const& [value, text] : axis(-7.3, 12.1, 5).ticks) CHECK(std::fabs(std::remainder(value, 5.0)) < 1e-12);
}

TEST_CASE("large and small numbers share a power of ten that is a multiple of three") {
  Axis const a = axis(4.9e9, 5.1e9, 4);
  CHECK(a.exponent == 9);
  CHECK(a.low == doctest::Approx(4.9));
  CHECK(a.scaled(5e9) == doctest::Approx(5));
  CHECK(axis(-2e-4, 3e-4, 4).exponent == -6);
  CHECK(axis(0, 500, 4).exponent == 0);
  CHECK(axis_label("k3", "N/m^3", 9) == "k3 [10⁹ N/m³]");
  CHECK(axis_label("y", "m", -3) == "y [mm]");
  CHECK(axis_label("y", "mm", -3) == "y [10⁻³ mm]");
  CHECK(axis_label("time", "s", 3) == "time [10³ s]");
  CHECK(axis_label("x", "", 0) == "x");
  CHECK(axis_label("ratio", "-", 0) == "ratio");
  CHECK(axis_label("n", "", 6) == "n [10⁶]");
}

TEST_CASE("what differs in its rounding alone has the axis of a constant") {
  for (double const value : {-32.5, 3e-5, 7e8}) {
    Axis const a = axis(value, std::nextafter(std::nextafter(value, 1e9), 1e9), 5);
    CHECK(a.ticks.size() >= 2);
    CHECK(a.ticks.size() <= 12);
  }
}

TEST_CASE("a constant has an axis with room around it") {
  for (double const value : {0.0, 3.0, -2e9}) {
    Axis const a = axis(value, value, 3);
    CHECK(a.low < a.scaled(value));
    CHECK(a.high > a.scaled(value));
    CHECK_FALSE(a.ticks.empty());
  }
}

TEST_CASE("two ticks are left to read a scale from, however few are asked for") {
  for (double const high : {2.1, 4.2, 7.0, 9.9, 33.0})
    for (double const low : {-0.93 * high, 0.0, 0.2 * high})
      CHECK_MESSAGE(axis(low, high, 3).ticks.size() >= 2, low << " to " << high);
  CHECK(axis(-3.98, 4.11, 3, 0.06).ticks.size() == 5);  // -4, -2, 0, 2, 4
}

TEST_CASE("a negative tick has a real minus and zero has none") {
  Axis const a = axis(-1, 1, 2);
  REQUIRE(a.ticks.size() == 3);
  CHECK(a.ticks[0].second == "−1");
  CHECK(a.ticks[1].second == "0");
}

TEST_CASE("a range that falls short of a tick by a hair is lengthened") {
  Axis a = axis(0, 0.499, 5);
  a.reach_ticks();
  CHECK(a.high == doctest::Approx(0.5));
  CHECK(a.ticks.back().second == "0.5");
  Axis b = axis(0, 0.46, 5);
  b.reach_ticks();
  CHECK(b.high == doctest::Approx(0.46));
}

TEST_CASE("a text cannot leave its quotes") {
  CHECK(quote("y'") == "'y'''");
  CHECK(quote("y'' [kg]") == "'y'.\"''\".' [kg]'");
  CHECK(quote("'''") == "''.\"'''\".''");
  CHECK(quote("a\nplot 1") == "'aplot 1'");
}

TEST_CASE("names of files and identifiers are plain") {
  CHECK(identifier("bench.train y'") == "bench_train_y_dot");
  CHECK(identifier("../x;rm") == "___x_rm");
}

TEST_CASE("the range ignores what is not finite") {
  CHECK(finite_range({std::nan(""), 2, -1, INFINITY}) == std::pair(-1.0, 2.0));
  CHECK(finite_range({std::nan("")}) == std::pair(0.0, 1.0));
}

TEST_CASE("numbers that would run into each other are left out, zero keeps its own") {
  Axis a = axis(-3, 3, 6);
  REQUIRE(a.ticks.size() == 7);
  a.thin_numbers(60, false);
  int left = 0;
  for (auto const& [place, number] : a.ticks)
    if (!number.empty()) ++left;
  CHECK(left < 7);
  CHECK(a.ticks[3].second == "0");
  Axis wide = axis(-3, 3, 6);
  wide.thin_numbers(600, false);
  for (auto const& [place, number] : wide.ticks) CHECK_FALSE(number.empty());
}

TEST_CASE("what hardly varies is counted from what its numbers share") {
  Axis const a = axis(15.9145 - 2e-7, 15.9145 + 2e-7, 4, 0.05);
  CHECK(a.origin_text == "15.9145");
  CHECK(a.exponent == -9);
  CHECK(a.scaled(15.9145 + 1e-7) == doctest::Approx(100).epsilon(1e-6));
  CHECK(a.unscaled(a.scaled(15.9145001)) == doctest::Approx(15.9145001).epsilon(1e-14));
  CHECK(axis_label("f", "Hz", a) == "f − 15.9145 [nHz]");
  CHECK(axis_label("f", "Hz", axis(-15.9145 - 2e-7, -15.9145 + 2e-7, 4, 0.05)) == "f + 15.9145 [nHz]");
  CHECK(axis(15.9, 15.95, 4).origin_text.empty());
}

TEST_CASE("a text that is too wide loses the middle of its name, not its unit nor the number it ends in") {
  CHECK(shortened("k [N/m]", 200) == "k [N/m]");
  std::string const label = shortened("a_name_that_is_much_longer_than_its_place_17 [10⁹ N/m³]", 150);
  CHECK(label.ends_with("…_17 [10⁹ N/m³]"));
  CHECK(label.starts_with("a_na"));
  CHECK(text_pixels(label) <= 150);
  CHECK(shortened("äöüäöüäöüäöü", 40) == "äö…äöü");
  CHECK(shortened("abcdef", 30) == "abc…");
  CHECK(shortened("k3 [10³ 1/(V²·s²)]", 80) == "k3 [10³ …]");
  CHECK(shortened("k3 [1/(V²·s²)]", 60) == "k3 […]");
  CHECK(shortened("k − 184295 [10³ 1/s²]", 125) == "k − 184295 [10³ …]");
  CHECK(shortened("velocity [m/s]", 90) == "veloci… [m/s]");
}
