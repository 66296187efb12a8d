// The bound of "worse than the mean", against quantiles of Student's t.
#include "diagnostics/residuals/explained.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace sysid;

TEST_CASE("a prediction is worse than the mean beyond the quantile of Student's t") {
  // scipy.stats.t.isf(5e-4, n - 1)^2
  CHECK(as_bad_as_the_mean(5) == doctest::Approx(100 * (1 + 74.13729332230893 / 4)).epsilon(1e-7));
  CHECK(as_bad_as_the_mean(20) == doctest::Approx(100 * (1 + 15.080840991801658 / 19)).epsilon(1e-7));
  CHECK(as_bad_as_the_mean(100) == doctest::Approx(100 * (1 + 11.502467880456077 / 99)).epsilon(1e-7));
  CHECK(std::isinf(as_bad_as_the_mean(1)));
}
