// The bump: its integral, its ends, its derivatives.
#include "regression/weak/test_function.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "relative.hpp"

using sysid::relative;
using sysid::regression::TestFunction;

TEST_CASE("the test function has integral 1, and its derivatives integrate against powers as parts say") {
  for (int const p : {4, 8, 16}) {
    TestFunction const phi(p);
    int const n = 20000;
    double integral = 0, second_moment = 0, first_by_s = 0, second_by_square = 0;
    for (int i = 0; i <= n; ++i) {
      double const s = -1 + 2.0 * i / n, h = 2.0 / n;  // both ends are zero: the rectangle rule is the trapezoidal one
      integral += h * phi.derivative(0, s);
      second_moment += h * s * s * phi.derivative(0, s);
      first_by_s += h * s * phi.derivative(1, s);
      second_by_square += h * s * s * phi.derivative(2, s);
    }
    CHECK(integral == doctest::Approx(1).epsilon(1e-10));
    CHECK(second_moment == relative(1.0 / (2 * p + 3), 1e-9));  // of the beta distribution
    CHECK(first_by_s == doctest::Approx(-1).epsilon(1e-9));
    CHECK(second_by_square == doctest::Approx(2).epsilon(1e-9));
  }
}

TEST_CASE("each derivative of the test function is the slope of the one before, and vanishes at the ends") {
  TestFunction const phi(8);
  for (int order = 1; order <= 3; ++order) {
    for (double s = -0.95; s < 1; s += 0.1) {
      double const h = 1e-5;
      double const slope = (phi.derivative(order - 1, s + h) - phi.derivative(order - 1, s - h)) / (2 * h);
      CHECK(phi.derivative(order, s) == doctest::Approx(slope).epsilon(1e-6).scale(10));
    }
    CHECK(phi.derivative(order, 1) == 0);
    CHECK(phi.derivative(order, -1) == 0);
  }
  std::vector<double> const samples = phi.samples(2, 5);
  REQUIRE(samples.size() == 11);
  CHECK(samples[7] == phi.derivative(2, 0.4));
}
