#include "likelihood/segments/coefficient_prior.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace sysid;

TEST_CASE("the weight of a coefficient is the integral of its likelihood over its prior, which integrates to one") {
  // By the midpoint rule, the likelihood away from 0.
  double const signal = 300;
  for (double const estimate : {-0.3, 2.0, 5e4}) {
    double const sd = std::abs(estimate) / 12, size = signal * sd;
    auto const prior = [&](double c) { return std::exp(-std::abs(std::log(std::abs(c) / size)) / 1.5) / (6 * std::abs(c)); };
    double const from = estimate - 8 * sd, step = 16 * sd / 20000;
    double sum = 0;
    for (int i = 0; i < 20000; ++i) {
      double const c = from + (i + 0.5) * step, z = (c - estimate) / sd;
      sum += step * std::exp(-z * z / 2) * prior(c);
    }
    Eigen::MatrixXd upper(1, 1);
    upper(0, 0) = 1 / sd;
    CHECK(log_coefficient_weight(Eigen::VectorXd::Constant(1, estimate), upper, signal) ==
          doctest::Approx(std::log(sum)).epsilon(0.005).scale(0));
    double all = 0;  // both signs, over the logarithm
    for (double u = -40; u < 40; u += 0.01) all += 2 * 0.01 * prior(size * std::exp(u)) * size * std::exp(u);
    CHECK(all == doctest::Approx(1).epsilon(1e-3));
  }
}

TEST_CASE("the weight of coefficients does not depend on their units, and falls with the signal that they are small against") {
  Eigen::MatrixXd upper(2, 2);
  upper << 30, 10, 0, 5;
  Eigen::VectorXd estimate(2), unit(2);
  estimate << 0.4, -3;
  unit << 1e6, 1e-3;
  Eigen::MatrixXd const scaled = upper * unit.cwiseInverse().asDiagonal();
  CHECK(log_coefficient_weight(estimate.cwiseProduct(unit), scaled, 500) ==
        doctest::Approx(log_coefficient_weight(estimate, upper, 500)).epsilon(1e-12));
  CHECK(log_coefficient_weight(estimate, upper, 1000) ==
        doctest::Approx(log_coefficient_weight(estimate, upper, 500) - 2 / 1.5 * std::log(2.0)).epsilon(1e-12));
}
