// Numbers as text: decades, rounding, and the digits that are shown.
#include "core/text/number.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

using namespace sysid;

TEST_CASE("the decade of a number is that of its leading digit, just below powers of ten too") {
  CHECK(decade(1) == 0);
  CHECK(decade(-999.9) == 2);
  CHECK(decade(std::nextafter(1000.0, 0.0)) == 2);
  CHECK(decade(0.001) == -3);
}

TEST_CASE("numbers keep the digits asked for, or all of them") {
  CHECK(significant(9.996, 3) == "10.0");
  CHECK(significant(0, 3) == "0");
  CHECK(significant(std::nan(""), 3) == "-");
  CHECK(significant(4.9864e9, 4) == "4.986e9");
  CHECK(with_exponent(-0.001, 1, 0) == "0.0");
  CHECK(shortest(0.1) == "0.1");
  CHECK(shortest(-std::numeric_limits<double>::infinity()) == "-Inf");
  CHECK(shortest(std::nan("")) == "NaN");
  CHECK(probability_text(0) == "0.000");
  CHECK(probability_text(0.0004) == "< 0.001");
  CHECK(probability_text(0.9876) == "0.988");
}

TEST_CASE("numbers and units are set as a reader likes them") {
  CHECK(pretty_number("4.986e9") == "4.986·10⁹");
  CHECK(pretty_number("-1e-3") == "−1·10⁻³");
  CHECK(pretty_unit("N s/m^3") == "N·s/m³");
  CHECK("2.44" + unit_after_number("m/s") == "2.44 m/s");
  CHECK("2.44" + unit_after_number("-") == "2.44");
  CHECK("2.44" + unit_after_number("") == "2.44");
  CHECK(pretty_units("input x = a [m/s^2], y") == "input x = a [m/s²], y");
  CHECK(pretty_powers("m^1.5") == "m^1.5");
  CHECK(superscript(-12) == "⁻¹²");
}

TEST_CASE("columns stand two blanks apart, the first to the left and the rest to the right") {
  CHECK(align_columns({{"k", "1"}, {"größe", "10.5"}}, 1) == "k         1\ngröße  10.5\n");
}
