// The step of a record that has gaps, or rounded times.
#include "data/cell/usual_step.hpp"

#include <doctest/doctest.h>

#include <vector>

using namespace sysid;

TEST_CASE("the usual step is the mean without gaps, and with gaps that of most rows") {
  UsualStep const equal = usual_step(std::vector<double>{0, 0.01, 0.02, 0.03});
  CHECK(equal.step == 0.01);
  CHECK(equal.gaps == 0);
  UsualStep const rounded = usual_step(std::vector<double>{0, 0.3, 0.7, 1});  // a third, to one digit
  CHECK(rounded.step == doctest::Approx(1.0 / 3).epsilon(1e-15));
  CHECK(rounded.gaps == 0);
  UsualStep const gap = usual_step(std::vector<double>{0, 1, 2, 3, 100, 101, 102});
  CHECK(gap.step == 1);
  CHECK(gap.gaps == 1);
  CHECK(gap.is_gap(97));
  CHECK_FALSE(gap.is_gap(1.4));
}
