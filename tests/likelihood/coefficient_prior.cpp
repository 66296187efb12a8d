#include "likelihood/segments/coefficient_prior.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace sysid;

TEST_CASE("the weight of a coefficient is the integral of its likelihood over the log-uniform prior") {
  // By the midpoint rule, away from 0 where the prior ends.
  double const scales = 7;
  for (double const estimate : {-0.3, 2.0, 5e4}) {
    double const sd = std::abs(estimate) / 12, from = estimate - 8 * sd, step = 16 * sd / 20000;
    double sum = 0;
    for (int i = 0; i < 20000; ++i) {
      double const c = from + (i + 0.5) * step, z = (c - estimate) / sd;
      sum += step * std::exp(-z * z / 2) / (2 * scales * std::abs(c));
    }
    Eigen::MatrixXd upper(1, 1);
    upper(0, 0) = 1 / sd;
    CHECK(log_coefficient_weight(Eigen::VectorXd::Constant(1, estimate), upper, scales) ==
          doctest::Approx(std::log(sum)).epsilon(0.005).scale(0));
  }
}

TEST_CASE("the weight of coefficients does not depend on their units") {
  Eigen::MatrixXd upper(2, 2);
  upper << 30, 10, 0, 5;
  Eigen::VectorXd estimate(2), unit(2);
  estimate << 0.4, -3;
  unit << 1e6, 1e-3;
  Eigen::MatrixXd const scaled = upper * unit.cwiseInverse().asDiagonal();
  CHECK(log_coefficient_weight(estimate.cwiseProduct(unit), scaled, 5) ==
        doctest::Approx(log_coefficient_weight(estimate, upper, 5)).epsilon(1e-12));
  CHECK(log_coefficient_weight(estimate, upper, 10) ==
        doctest::Approx(log_coefficient_weight(estimate, upper, 5) - 2 * std::log(2.0)).epsilon(1e-12));
}
