// Units: what the atoms are worth in SI, their algebra, and the conversions that must be refused.
#include "core/numeric/unit.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <numbers>
#include <thread>

#include "relative.hpp"

using namespace sysid;

namespace {

/// Whole exponents of kg, m, s, A, K, mol, cd.
Dimension dimension(int kg, int m, int s, int ampere = 0, int kelvin = 0) {
  Dimension result{};
  int const exponents[] = {kg, m, s, ampere, kelvin};
  for (std::size_t i = 0; i < std::size(exponents); ++i) result[i] = {exponents[i], 1};
  return result;
}

Unit atom(std::string_view name) {
  std::optional<Unit> const unit = unit_atom(name);
  REQUIRE_MESSAGE(unit, "unknown unit " << name);
  return *unit;
}

}  // namespace

TEST_CASE("rational arithmetic stays reduced with a positive denominator") {
  CHECK(Rational{1, 2} + Rational{1, 3} == Rational{5, 6});
  CHECK(Rational{1, 2} - Rational{1, 2} == Rational{0, 1});
  CHECK(Rational{2, 3} * Rational{3, 4} == Rational{1, 2});
  CHECK(Rational{1, 6} - Rational{1, 2} == Rational{-1, 3});
}

TEST_CASE("a number is a rational when a denominator up to 64 fits") {
  CHECK(to_rational(2.0) == Rational{2, 1});
  CHECK(to_rational(-0.5) == Rational{-1, 2});
  CHECK(to_rational(1.0 / 3) == Rational{1, 3});
  CHECK(to_rational(0.0) == Rational{0, 1});
  CHECK_FALSE(to_rational(std::numbers::pi));
  CHECK_FALSE(to_rational(1e300));
  CHECK_FALSE(to_rational(std::numeric_limits<double>::quiet_NaN()));
}

TEST_CASE("the units of mechanics and electricity have their SI dimensions and scales") {
  struct Row {
    char const* name;
    Dimension dimension;
    double scale;
  };
  Row const rows[] = {{"m", dimension(0, 1, 0), 1},          {"mm", dimension(0, 1, 0), 1e-3},
                      {"kg", dimension(1, 0, 0), 1},         {"g", dimension(1, 0, 0), 1e-3},
                      {"mg", dimension(1, 0, 0), 1e-6},      {"t", dimension(1, 0, 0), 1e3},
                      {"s", dimension(0, 0, 1), 1},          {"ms", dimension(0, 0, 1), 1e-3},
                      {"min", dimension(0, 0, 1), 60},       {"h", dimension(0, 0, 1), 3600},
                      {"N", dimension(1, 1, -2), 1},         {"kN", dimension(1, 1, -2), 1e3},
                      {"Pa", dimension(1, -1, -2), 1},       {"MPa", dimension(1, -1, -2), 1e6},
                      {"bar", dimension(1, -1, -2), 1e5},    {"mbar", dimension(1, -1, -2), 1e2},
                      {"J", dimension(1, 2, -2), 1},         {"W", dimension(1, 2, -3), 1},
                      {"Hz", dimension(0, 0, -1), 1},        {"kHz", dimension(0, 0, -1), 1e3},
                      {"A", dimension(0, 0, 0, 1), 1},       {"V", dimension(1, 2, -3, -1), 1},
                      {"ohm", dimension(1, 2, -3, -2), 1},   {"kohm", dimension(1, 2, -3, -2), 1e3},
                      {"F", dimension(-1, -2, 4, 2), 1},     {"H", dimension(1, 2, -2, -2), 1},
                      {"T", dimension(1, 0, -2, -1), 1},     {"K", dimension(0, 0, 0, 0, 1), 1},
                      {"L", dimension(0, 3, 0), 1e-3},       {"in", dimension(0, 1, 0), 0.0254},
                      {"ft", dimension(0, 1, 0), 0.3048},    {"lbf", dimension(1, 1, -2), 4.4482216152605},
                      {"g_n", dimension(0, 1, -2), 9.80665}, {"um", dimension(0, 1, 0), 1e-6},
                      {"µm", dimension(0, 1, 0), 1e-6},      {"μm", dimension(0, 1, 0), 1e-6},
                      {"Ω", dimension(1, 2, -3, -2), 1}};
  for (Row const& row : rows) {
    CAPTURE(row.name);
    Unit const unit = atom(row.name);
    CHECK(unit.dimension == row.dimension);
    CHECK(unit.scale == relative(row.scale, 1e-14));
    CHECK(unit.offset == 0);
    CHECK(unit.text == row.name);
  }
}

TEST_CASE("dimensionless atoms are the dash, the one, the percent and the angles") {
  for (char const* name : {"-", "1", "rad", "strain", "sr"}) {
    CAPTURE(name);
    CHECK(atom(name).dimensionless());
    CHECK(atom(name).scale == 1);
  }
  CHECK(atom("%").scale == 0.01);
  CHECK(atom("percent").scale == 0.01);
  CHECK(atom("ppm").scale == relative(1e-6, 1e-14));
  CHECK(atom("microstrain").scale == 1e-6);
  CHECK(atom("deg").scale == relative(std::numbers::pi / 180, 1e-14));
  CHECK(atom("rev").scale == doctest::Approx(2 * std::numbers::pi).epsilon(1e-14));
  CHECK(atom("percent").dimensionless());
  CHECK(atom("deg").dimensionless());
}

TEST_CASE("an unknown atom, a unit expression and a decibel are no atoms") {
  for (char const* name :
       {"", "newtonn", "furlongs_per_fortnight", "m/s", "m2", "2 m", "dB", "mph", "kdegC", "mmm", "mkg", "m s", "kiloNewton"}) {
    CAPTURE(name);
    CHECK_FALSE(unit_atom(name));
  }
}

TEST_CASE("a degree Celsius carries its offset and a difference of them does not") {
  CHECK(convert(20, atom("degC"), atom("K")) == doctest::Approx(293.15).epsilon(1e-15));
  CHECK(convert(293.15, atom("K"), atom("degC")) == doctest::Approx(20).epsilon(1e-14));
  CHECK(convert(212, atom("degF"), atom("degC")) == doctest::Approx(100).epsilon(1e-13));
  CHECK(convert(-40, atom("degC"), atom("degF")) == doctest::Approx(-40).epsilon(1e-13));
  CHECK(convert(5, atom("delta_degC"), atom("K")) == 5);
  CHECK(convert(9, atom("delta_degF"), atom("K")) == doctest::Approx(5).epsilon(1e-14));
}

TEST_CASE("a conversion between equal units changes no bit") {
  double const value = 0.1 + 0.2;
  CHECK(convert(value, atom("mm"), atom("mm")) == value);
  CHECK(convert(value, atom("degC"), atom("degC")) == value);
  CHECK(convert(1500, atom("mm"), atom("m")) == 1.5);
  CHECK(convert(3, atom("kN"), atom("N")) == 3000);
}

TEST_CASE("products, quotients and powers combine dimension and scale") {
  Unit const stiffness = divide(atom("N"), atom("mm"));
  CHECK(stiffness.dimension == dimension(1, 0, -2));
  CHECK(stiffness.scale == doctest::Approx(1e3).epsilon(1e-15));
  CHECK(stiffness.text.empty());
  Unit const area = power(atom("mm"), {2, 1});
  CHECK(area.dimension == dimension(0, 2, 0));
  CHECK(area.scale == relative(1e-6, 1e-15));
  Unit const root = power(area, {1, 2});
  CHECK(root.dimension == dimension(0, 1, 0));
  CHECK(root.scale == relative(1e-3, 1e-15));
  CHECK(power(atom("km"), {-1, 1}).scale == relative(1e-3, 1e-15));
  CHECK(power(atom("km"), {1, 3}).scale == doctest::Approx(10).epsilon(1e-14));
  CHECK(multiply(atom("N"), atom("m")).dimension == atom("J").dimension);
}

TEST_CASE("an offset survives the factor one and the power one, and no other") {
  CHECK(multiply(Unit{}, atom("degC")).offset == 273.15);
  CHECK(multiply(atom("degC"), atom("-")).offset == 273.15);
  CHECK(divide(atom("degC"), Unit{}).offset == 273.15);
  CHECK(power(atom("degC"), {1, 1}).offset == 273.15);
  CHECK(divide(atom("W"), atom("degC")).offset == 0);
  CHECK(multiply(atom("degC"), atom("s")).offset == 0);
  CHECK(power(atom("degC"), {2, 1}).offset == 0);
}

TEST_CASE("cycles against radians are told apart where the SI sees the same unit") {
  Unit const angular = divide(atom("rad"), atom("s"));
  Unit const rate = divide(Unit{}, atom("s"));
  CHECK(convert(1, atom("Hz"), angular) == 1);  // which is why it must be refused
  CHECK(cycles_against_radians(atom("Hz"), angular));
  CHECK(cycles_against_radians(angular, atom("kHz")));
  CHECK(cycles_against_radians(atom("rpm"), atom("hertz")));
  CHECK(cycles_against_radians(atom("rpm"), atom("Hertz")));
  CHECK_FALSE(cycles_against_radians(atom("rpm"), angular));
  CHECK_FALSE(cycles_against_radians(atom("Hz"), atom("kHz")));
  CHECK_FALSE(cycles_against_radians(atom("Hz"), rate));
  CHECK_FALSE(cycles_against_radians(rate, angular));
  CHECK(cycles_against_radians(atom("rpm"), divide(Unit{}, atom("min"))));
  CHECK_FALSE(cycles_against_radians(divide(atom("N"), atom("rad")), atom("N")));
}

TEST_CASE("a dimension is written as a unit expression in SI bases") {
  CHECK(format_dimension(Dimension{}) == "1");
  CHECK(format_dimension(atom("N").dimension) == "kg m/s^2");
  CHECK(format_dimension(atom("Pa").dimension) == "kg/(m s^2)");
  CHECK(format_dimension(atom("Hz").dimension) == "1/s");
  CHECK(format_dimension(power(atom("m"), {1, 2}).dimension) == "m^(1/2)");
  CHECK(format_dimension(divide(atom("N"), power(atom("m"), {3, 1})).dimension) == "kg/(m^2 s^2)");
  CHECK(atom("N").text_or_dimension() == "N");
  CHECK(divide(atom("N"), atom("m")).text_or_dimension() == "kg/s^2");
}

TEST_CASE("every common name is a unit") {
  for (std::string const& name : common_unit_names()) {
    CAPTURE(name);
    CHECK(unit_atom(name));
  }
}

TEST_CASE("units are read by many threads at once with the same result") {
  std::vector<double> scales(8);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < scales.size(); ++i)
    threads.emplace_back([&scale = scales[i]] {
      for (int k = 0; k < 200; ++k) scale = unit_atom("kN").value_or(Unit{}).scale + (unit_atom("nonsense") ? 1 : 0);
    });
  for (std::thread& thread : threads) thread.join();
  for (double const scale : scales) CHECK(scale == 1e3);
}
