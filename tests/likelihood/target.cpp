// Derivatives that every target has, by differences, against those of formulas.
#include "likelihood/target.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "inference/targets.hpp"

using namespace sysid;
using sysid::testing::Prior;
using sysid::testing::TestTarget;

namespace {

constexpr double edge = 4;  // no solution from here on

/// r = (x^2 - 1, x y - 3, 2 y), x and y on the line; it fails from x = 4 on.
TestTarget curved() {
  return TestTarget({"x", "y"}, {{Prior::normal, 0, 1}, {Prior::normal, 1, 2}}, 3, 7,
                    [](std::vector<double> const& v, std::vector<double>& r) {
                      r = {v[0] * v[0] - 1, v[0] * v[1] - 3, 2 * v[1]};
                      if (v[0] >= edge) r[0] = std::nan("");
                    });
}

LaneArray lanes(std::vector<std::pair<double, double>> const& points) {
  LaneArray theta(2, static_cast<int>(points.size()));
  for (std::size_t w = 0; w < points.size(); ++w) {
    theta(0, static_cast<int>(w)) = points[w].first;
    theta(1, static_cast<int>(w)) = points[w].second;
  }
  return theta;
}

// Steps h are 1e-5 of widths of about 1 and 2: the second order leaves h^2 f'''/6 and rounding 1e-16 f/h, both below 1e-8 here.
constexpr double tolerance = 1e-8;

}  // namespace

TEST_CASE("gradient and Jacobian by differences are those of the formula, and a lane is the same alone") {
  TestTarget const target = curved();
  std::vector<std::pair<double, double>> const points = {{0.5, 1}, {-2, 0.3}, {1, 3}};
  LaneArray const theta = lanes(points);
  int const width = theta.width();
  Ledger ledger;
  std::vector<double> value(points.size()), plain(points.size());
  LaneArray gradient(2, width), residuals(3, width), jacobian(6, width);
  target.log_likelihood_gradient(theta, value, gradient, ledger);
  target.residuals_with_jacobian(theta, residuals, jacobian, ledger);
  target.log_likelihood(theta, plain, ledger);
  CHECK(target.derivatives() == DerivativeSource::differences);
  CHECK(value == plain);
  for (int w = 0; w < width; ++w) {
    CAPTURE(w);
    auto const [x, y] = points[static_cast<std::size_t>(w)];
    double const r[] = {x * x - 1, x * y - 3, 2 * y}, j[3][2] = {{2 * x, 0}, {y, x}, {0, 2}};
    for (int p = 0; p < 2; ++p) {
      double expected = 0;
      for (int k = 0; k < 3; ++k) {
        CHECK(residuals(k, w) == r[k]);
        CHECK(std::fabs(jacobian(2 * k + p, w) - j[k][p]) < tolerance);
        expected -= r[k] * j[k][p];
      }
      CHECK(std::fabs(gradient(p, w) - expected) < tolerance);
    }
    LaneArray alone(2, 1);
    double one = 0;
    target.log_likelihood_gradient(theta.view().columns(w, 1), {&one, 1}, alone, ledger);
    CHECK(alone(0, 0) == gradient(0, w));
    CHECK(alone(1, 0) == gradient(1, w));
  }
}

TEST_CASE("a failed solve has no derivative; one beside it has that of the side that is left") {
  TestTarget const target = curved();
  LaneArray const theta = lanes({{5, 1}, {edge - 1e-9, 1}});
  Ledger ledger;
  std::vector<double> value(2);
  LaneArray gradient(2, 2), residuals(3, 2), jacobian(6, 2);
  target.log_likelihood_gradient(theta, value, gradient, ledger);
  target.residuals_with_jacobian(theta, residuals, jacobian, ledger);
  CHECK(value[0] == -infinity);
  CHECK(residuals(1, 0) == infinity);
  for (int p = 0; p < 2; ++p) CHECK(gradient(p, 0) == 0);
  for (int row = 0; row < 6; ++row) CHECK(jacobian(row, 0) == 0);
  // First order: h f''/2 = 1e-5 * 47/2.
  double const expected = -(edge * edge - 1) * 2 * edge - (edge - 3);
  CHECK(std::fabs(gradient(0, 1) - expected) < 5e-4);
  CHECK(std::fabs(jacobian(0, 1) - 2 * edge) < 5e-4);
}

TEST_CASE("the gradient of the prior has the Jacobian of its coordinate, or has it not") {
  TestTarget const target({"a", "b"}, {{Prior::normal, 1, 2}, {Prior::uniform, 2, 5}}, 1, 0,
                          [](std::vector<double> const&, std::vector<double>& r) { r = {0}; });
  LaneArray const theta = lanes({{0.4, 0.7}});
  double const share = 1 / (1 + std::exp(-0.7));
  for (bool const jacobian : {true, false}) {
    CAPTURE(jacobian);
    double value = 0, plain = 0;
    LaneArray gradient(2, 1);
    target.log_prior_gradient(theta, {&value, 1}, gradient, jacobian);
    target.log_prior(theta, {&plain, 1}, jacobian);
    CHECK(value == plain);
    CHECK(std::fabs(gradient(0, 0) + (0.4 - 1) / 4) < tolerance);
    CHECK(std::fabs(gradient(1, 0) - (jacobian ? 1 - 2 * share : 0)) < tolerance);
  }
}

TEST_CASE("lanes are moved ahead and behind along some coordinates") {
  LaneArray theta(3, 2);
  for (int p = 0; p < 3; ++p)
    for (int w = 0; w < 2; ++w) theta(p, w) = 10 * p + w;
  std::vector<int> const coordinates = {0, 2};
  std::vector<double> const steps = {0.5, 1, 0.25};
  LaneArray const some = moved_lanes(theta, coordinates, steps);
  REQUIRE(some.width() == 10);
  CHECK(std::vector<double>(some.row(0).begin(), some.row(0).end()) == std::vector<double>{0, 0.5, -0.5, 0, 0, 1, 1.5, 0.5, 1, 1});
  CHECK(std::vector<double>(some.row(1).begin(), some.row(1).end()) == std::vector<double>{10, 10, 10, 10, 10, 11, 11, 11, 11, 11});
  CHECK(some(2, 3) == 20.25);
  CHECK(some(2, 9) == 20.75);
  LaneArray const all = moved_lanes(theta, steps);
  REQUIRE(all.width() == 14);
  CHECK(all(1, 3) == 11);
  CHECK(all(1, 4) == 9);
  CHECK(all(2, 13) == 20.75);
}

TEST_CASE("the residual that carries a density is fixed but for the density") {
  CHECK(scale_residual(10, 0) == std::sqrt(4000.0));
  CHECK(scale_residual(0, 1e6) == 0);
  double const more = scale_residual(7, 3), less = scale_residual(7, 1);
  CHECK(less * less - more * more == doctest::Approx(4));
}
