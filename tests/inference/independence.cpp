// Mixtures of independence proposals: their density is that of their draws.
#include "inference/chain/independence.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "core/numeric/random.hpp"
#include "linear_algebra/decompositions.hpp"
#include "search/stored_values.hpp"

using namespace sysid;
using metropolis::Independence;

namespace {

Independence::Component component(double weight, Eigen::VectorXd mean, Eigen::MatrixXd covariance) {
  return {weight, std::move(mean), std::move(covariance)};
}

Independence in_the_plane() {
  Eigen::Matrix2d wide, narrow;
  wide << 4, -1, -1, 0.5;
  narrow << 0.01, 0, 0, 9;
  return Independence({component(3, Eigen::Vector2d(1, -2), wide), component(1, Eigen::Vector2d(-6, 4), narrow)});
}

/// The three parts, written out.
double density(Eigen::VectorXd const& x, Eigen::VectorXd const& mean, Eigen::MatrixXd const& covariance) {
  double const p = static_cast<double>(x.size()), squares = (x - mean).dot(solve_symmetric(covariance, x - mean));
  double const root = std::exp(log_absolute_determinant(covariance) / 2);
  double const normal = std::exp(-squares / 2) / (std::pow(2 * std::numbers::pi, p / 2) * root);
  double const student = std::exp(std::lgamma((6 + p) / 2) - std::lgamma(3.0)) / (std::pow(6 * std::numbers::pi, p / 2) * root) *
                         std::pow(1 + squares / 6, -(6 + p) / 2);
  double axes = 0;
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    double const z = (x(j) - mean(j)) / std::sqrt(covariance(j, j));
    double const t = std::exp(std::lgamma(2.0) - std::lgamma(1.5)) / std::sqrt(3 * std::numbers::pi) * std::pow(1 + z * z / 3, -2);
    // t over the normal density of z, times the normal density of x: what is left is that of the other coordinates, given this one.
    axes += t * std::exp((z * z - squares) / 2) / (std::pow(2 * std::numbers::pi, (p - 1) / 2) * root) / p;
  }
  return 0.65 * normal + 0.25 * axes + 0.1 * student;
}

}  // namespace

TEST_CASE("the log density of a mixture is that of its formula") {
  Eigen::Matrix2d wide, narrow;
  wide << 4, -1, -1, 0.5;
  narrow << 0.01, 0, 0, 9;
  Independence const mixture = in_the_plane();
  Stream stream({3, Purpose::test, 0, 0});
  LaneArray theta(2, 1);
  for (int i = 0; i < 200; ++i) {
    Eigen::Vector2d const x(8 * stream.normal(), 8 * stream.normal());
    theta(0, 0) = x(0);
    theta(1, 0) = x(1);
    double const expected =
        std::log(0.75 * density(x, Eigen::Vector2d(1, -2), wide) + 0.25 * density(x, Eigen::Vector2d(-6, 4), narrow));
    CHECK(mixture.log_density(theta, 0) == doctest::Approx(expected).epsilon(1e-12));
  }
}

TEST_CASE("a batch has the draws and densities of its columns, bit for bit") {
  Independence const mixture = in_the_plane();
  constexpr int width = 37;
  std::vector<StreamKey> keys;
  for (std::uint64_t w = 0; w < width; ++w) keys.push_back({5, Purpose::test, w, 9});
  LaneArray all(2, width), one(2, 1);
  mixture.draw(keys, all);
  std::vector<double> densities(width);
  mixture.log_density(all, densities);
  for (int w = 0; w < width; ++w) {
    mixture.draw(keys[static_cast<std::size_t>(w)], one, 0);
    CHECK(one(0, 0) == all(0, w));
    CHECK(one(1, 0) == all(1, w));
    CHECK(densities[static_cast<std::size_t>(w)] == mixture.log_density(one, 0));
  }
}

TEST_CASE("draws of a mixture have its density") {
  // The mean of f / q over draws of q is the integral of f: 1 for any density f, here one that q covers in one place each.
  Independence const mixture = in_the_plane();
  constexpr int draws = 40000;
  LaneArray theta(2, draws);
  for (int w = 0; w < draws; ++w) mixture.draw({7, Purpose::test, static_cast<std::uint64_t>(w), 0}, theta, w);
  for (Eigen::Vector2d const& centre : {Eigen::Vector2d(1, -2), Eigen::Vector2d(2.5, -2.5), Eigen::Vector2d(-6, 1)}) {
    CAPTURE(centre.x());
    double sum = 0, squares = 0;
    for (int w = 0; w < draws; ++w) {
      double const far = std::pow((theta(0, w) - centre(0)) / 0.08, 2) + std::pow((theta(1, w) - centre(1)) / 0.3, 2);
      double const ratio = std::exp(-far / 2 - mixture.log_density(theta, w)) / (2 * std::numbers::pi * 0.08 * 0.3);
      sum += ratio;
      squares += ratio * ratio;
    }
    double const mean = sum / draws, error = std::sqrt((squares / draws - mean * mean) / draws);
    CHECK(error < 0.05);
    CHECK(std::fabs(mean - 1) < 4 * error);
  }
}

TEST_CASE("a place is nearest to the component that most likely drew it") {
  Independence const mixture = in_the_plane();
  LaneArray theta(2, 2);
  theta(0, 0) = 1, theta(1, 0) = -2;
  theta(0, 1) = -6, theta(1, 1) = -3;
  CHECK(mixture.nearest(theta, 0) == 0);
  CHECK(mixture.nearest(theta, 1) == 1);
  CHECK(Independence().empty());
  CHECK(Independence().log_density(theta, 0) == -std::numeric_limits<double>::infinity());
}

TEST_CASE("a stored mixture is the same to the last bit, and one of another dimension is refused") {
  Independence const mixture = in_the_plane();
  Independence const again = Independence::restore(mixture.store(), 2);
  LaneArray a(2, 1), b(2, 1);
  for (std::uint64_t i = 0; i < 50; ++i) {
    mixture.draw({1, Purpose::test, i, 0}, a, 0);
    again.draw({1, Purpose::test, i, 0}, b, 0);
    CHECK(a(0, 0) == b(0, 0));
    CHECK(mixture.log_density(a, 0) == again.log_density(b, 0));
  }
  CHECK_THROWS_AS(Independence::restore(mixture.store(), 3), checkpoint::Mismatch);
}
