// Laplace's approximation of many parameters, whose curvature is not measured in full.
#include "search/laplace.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>

#include "inference/targets.hpp"
#include "linear_algebra/decompositions.hpp"
#include "relative.hpp"
#include "search/global/search.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

/// Rows of a regression on neighbours that are alike, correlations of 0.9.
Eigen::MatrixXd correlated_columns(int rows, int columns) {
  Stream stream({5, Purpose::test, 0, 0});
  Eigen::MatrixXd x(rows, columns);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) x(r, c) = (c > 0 ? 0.9 * x(r, c - 1) : 0) + stream.normal();
  return x;
}

}  // namespace

TEST_CASE("sds of many parameters are exact, that of the noise too, which Gauss-Newton's rows show by half") {
  constexpr int coefficients = 29, rows = 400;
  Eigen::MatrixXd const x = correlated_columns(rows, coefficients);
  Stream stream({6, Purpose::test, 0, 0});
  Eigen::VectorXd y(rows);
  for (double& each : y) each = 0.3 * stream.normal();
  std::vector<std::string> names;
  std::vector<Prior> priors;
  for (int c = 0; c < coefficients; ++c) {
    names.push_back("b" + std::to_string(c));
    priors.push_back({Prior::normal, 0, 100});
  }
  names.emplace_back("sigma");
  priors.push_back({Prior::log_uniform, 1e-3, 1e3});
  TestTarget const target(names, priors, rows + 1, 0, [&](std::vector<double> const& w, std::vector<double>& r) {
    Eigen::VectorXd const misfit = y - x * Eigen::Map<Eigen::VectorXd const>(w.data(), coefficients);
    double const sigma = w.back();
    for (int i = 0; i < rows; ++i) r[static_cast<std::size_t>(i)] = misfit(i) / sigma;
    r[rows] = std::sqrt(2 * (1e5 + rows * std::log(sigma)));
  });
  Bench bench;
  Mode const mode = search(target, ObjectiveKind::likelihood, bench.context).modes.front();
  Eigen::VectorXd const best = OrthogonalTriangular(x).solve(y);
  double const sigma = std::sqrt((y - x * best).squaredNorm() / rows);
  CHECK(mode.declared.back() == relative(sigma, 1e-3));
  CHECK(mode.sd.back() == relative(sigma / std::sqrt(2.0 * rows), 0.01));
  Eigen::MatrixXd const covariance = sigma * sigma * inverse(x.transpose() * x);
  for (int c = 0; c < coefficients; ++c) CHECK(mode.sd[static_cast<std::size_t>(c)] == relative(std::sqrt(covariance(c, c)), 0.01));
}

namespace {

/// a and b, prior sd 1, of which the data know a - b, or a b, to 1e-9; and b to `width`, if that is finite.
TestTarget narrow(bool product, double width) {
  return {
      {"a", "b"}, {{Prior::normal, 0, 1}, {Prior::normal, 0, 1}}, 2, 0, [=](std::vector<double> const& w, std::vector<double>& r) {
        r[0] = (product ? w[0] * w[1] - 0.5 : w[0] - w[1]) / 1e-9;
        r[1] = (w[1] - 0.3) / width;
      }};
}

}  // namespace

TEST_CASE("a direction that is a million times as long as the narrowest, and a thousandth of the prior, is not flat") {
  Bench bench;
  Mode const mode = search(narrow(false, 1e-3), ObjectiveKind::posterior, bench.context).modes.front();
  CHECK(mode.flat.empty());
  CHECK(mode.sd[0] == relative(1e-3, 0.01));
  CHECK(mode.sd[1] == relative(1e-3, 0.01));
}

TEST_CASE("a ridge as long as the prior is flat however narrow it is, straight or bent") {
  for (bool const product : {false, true}) {
    CAPTURE(product);
    Bench bench;
    CHECK_FALSE(search(narrow(product, INFINITY), ObjectiveKind::likelihood, bench.context).modes.front().flat.empty());
  }
}

TEST_CASE("a ridge of a likelihood is flat in the coordinates of an interval, too, and a wide optimum is not") {
  // y = p q x at ten points, measured to 0.1: p q is known to 2 %, p anything from 0.02 to 100.
  TestTarget const product({"p", "q"}, {{Prior::log_uniform, 0.01, 100}, {Prior::log_uniform, 0.01, 100}}, 10, 0,
                           [](std::vector<double> const& w, std::vector<double>& rows) {
                             for (std::size_t i = 0; i < rows.size(); ++i)
                               rows[i] = (w[0] * w[1] - 2) * static_cast<double>(i) / 0.1;
                           });
  Bench bench;
  Mode const ridge = search(product, ObjectiveKind::likelihood, bench.context).modes.front();
  REQUIRE(ridge.flat.size() == 2);
  CHECK(ridge.flat[0] * ridge.flat[1] < 0);
  // Where the coordinates are those of the factors, the ridge ends at 0 and goes on in the other one.
  for (auto const& priors : {std::vector<Prior>{{Prior::normal, 0, 100}, {Prior::normal, 0, 100}},
                             std::vector<Prior>{{Prior::uniform, 0, 100}, {Prior::uniform, 0, 1e6}}}) {
    TestTarget const factors({"p", "q"}, priors, 10, 0, [](std::vector<double> const& w, std::vector<double>& rows) {
      for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = (w[0] * w[1] - 2) * static_cast<double>(i) / 0.3;
    });
    CHECK_FALSE(search(factors, ObjectiveKind::likelihood, bench.context).modes.front().flat.empty());
  }
  // ln p is known to about as much as its prior knows it, ln q ten times better.
  TestTarget const wide({"p", "q"}, {{Prior::log_uniform, 0.01, 100}, {Prior::log_uniform, 0.01, 100}}, 2, 0,
                        [](std::vector<double> const& w, std::vector<double>& rows) {
                          rows[0] = std::log(w[0]) / 1.5;
                          rows[1] = std::log(w[1]) / 0.15;
                        });
  CHECK(search(wide, ObjectiveKind::likelihood, bench.context).modes.front().flat.empty());
}

TEST_CASE("a power of the likelihood leaves a mode between its own width and the prior's") {
  Mode mode;
  mode.theta = {0, 0};
  mode.covariance = {4, 1, 1, 9};
  Eigen::VectorXd const widths{{10, 20}};
  Eigen::MatrixXd const own = covariance_at_power(mode, 1, widths), prior = covariance_at_power(mode, 0, widths);
  CHECK((own - covariance_of(mode)).norm() < 1e-12);
  CHECK((prior - Eigen::MatrixXd(widths.cwiseAbs2().asDiagonal())).norm() < 1e-12 * 400);
  mode.covariance = {4, 0, 0, 9};
  Eigen::MatrixXd const half = covariance_at_power(mode, 0.5, widths);
  CHECK(half(0, 0) == doctest::Approx(1 / (0.5 / 4 + 0.5 / 100)));
  CHECK(half(1, 1) == doctest::Approx(1 / (0.5 / 9 + 0.5 / 400)));
}
