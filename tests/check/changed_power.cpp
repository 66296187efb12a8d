#include "check/units/changed_power.hpp"

#include <doctest/doctest.h>

using namespace sysid;

TEST_CASE("a unit changes in the names that it is written with") {
  auto const length = unit_atom("m").value().dimension, time = unit_atom("s").value().dimension;
  auto const per = [](Dimension dimension) {
    for (Rational& each : dimension) each.numerator = -each.numerator;
    return dimension;
  };
  CHECK(with_changed_power("N/mm^2", per(length)) == "N/mm^3");
  CHECK(with_changed_power("N/mm", length) == "N");
  CHECK(with_changed_power("mm", per(length)).empty());  // a pure number
  CHECK(with_changed_power("1/mm", per(length)) == "1/mm^2");
  CHECK(with_changed_power("N ms/mm", time) == "N ms^2/mm");
  CHECK(with_changed_power("N/(mm ms)", per(time)) == "N/(mm ms^2)");
  // No name for it, or two.
  CHECK(with_changed_power("N", length).empty());
  CHECK(with_changed_power("mm/m", length).empty());
  CHECK(with_changed_power("Hz", per(time)).empty());
  CHECK(with_changed_power("N^(1/2)/m", length).empty());
}
