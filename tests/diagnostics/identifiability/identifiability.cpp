// Slopes of functions whose derivatives are known, and null spaces of matrices made to have them.
#include "diagnostics/identifiability/identifiability.hpp"

#include <doctest/doctest.h>
#include <Eigen/Core>

#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/numeric/random.hpp"
#include "linear_algebra/decompositions.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr int rows = 40;

Matrix random_matrix(int columns, std::uint64_t seed) {
  Stream stream({seed, Purpose::test, 0, 0});
  Matrix m(rows, columns);
  for (double& x : m.reshaped()) x = stream.normal();
  return m;
}

// A draw at `value` with slopes [rows x P] per SI unit of each parameter, known to twelve digits.
LocalSlopes draw_at(Vector const& value, Matrix const& slopes) {
  LocalSlopes local;
  local.value = value;
  local.scale = value.cwiseAbs();
  local.spread = Vector::Ones(value.size());
  local.sensitivity.finite = true;
  Matrix const scaled = slopes * local.scale.asDiagonal();
  local.sensitivity.slopes = OrthogonalTriangular(scaled).triangle();
  local.sensitivity.error = 1e-12 * scaled.colwise().norm().transpose();
  local.sensitivity.size = 1;
  return local;
}

Vector positive(int size, std::uint64_t seed) {
  Stream stream({seed, Purpose::test, 1, 0});
  Vector v(size);
  for (double& x : v) x = elementary::exp(2 * stream.normal());
  return v;
}

// Slopes with directions(value) as null moves (SI): random ones less their part along them.
template <class Directions>
std::vector<LocalSlopes> draws(int parameters, Directions const& directions) {
  std::vector<LocalSlopes> out;
  for (std::uint64_t d = 0; d < 5; ++d) {
    Vector const value = positive(parameters, 100 + d);
    Matrix const null = directions(value);
    Matrix const q = OrthogonalTriangular(null).basis();
    Matrix const slopes = random_matrix(parameters, d);
    out.push_back(draw_at(value, slopes - slopes * q * q.transpose()));
  }
  return out;
}

std::vector<ParameterWords> const names = {{"m", "kg", 1}, {"c", "N s/m", 1}, {"k", "N/m", 1}, {"k3", "N/m^3", 1}, {"b", "", 1}};

std::string said(NullSpace const& space, std::size_t index = 0) {
  return direction_words(space.directions.at(index), names, "displacement");
}

}  // namespace

TEST_CASE("slopes of smooth functions agree with their derivatives, and the stated error covers the true one") {
  // f_i = a exp(-b t_i): df/da = exp(-b t), df/db = -a t exp(-b t).
  double const a = 3.0, b = 0.7;
  auto const outputs = [](ConstLanes points, Lanes out) {
    for (int i = 0; i < rows; ++i)
      for (int w = 0; w < points.width(); ++w) out(i, w) = points(0, w) * elementary::exp(-points(1, w) * 0.1 * i);
  };
  double const point[] = {a, b}, scale[] = {a, b};
  Sensitivity const s = sensitivity(outputs, rows, point, scale, 2);
  REQUIRE(s.finite);
  Matrix exact(rows, 2);
  for (int i = 0; i < rows; ++i) {
    double const t = 0.1 * i, e = elementary::exp(-b * t);
    exact(i, 0) = a * e;
    exact(i, 1) = -b * a * t * e;
  }
  // The factor keeps lengths and angles: compare the Gram matrices. Each entry errs by at most error times length, twice.
  Matrix const gram = s.slopes.transpose() * s.slopes, expected = exact.transpose() * exact;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      CHECK(std::abs(gram(i, j) - expected(i, j)) <= s.error(i) * exact.col(j).norm() + s.error(j) * exact.col(i).norm());
  for (int i = 0; i < 2; ++i) CHECK(s.error(i) < 1e-6 * exact.col(i).norm());
}

TEST_CASE("a nuisance is projected out, and with it what only it could explain") {
  // f = p g + q h + (p + q) * 0: with q free, only the part of g orthogonal to h tells about p.
  Matrix const g = random_matrix(2, 1);
  auto const outputs = [&](ConstLanes points, Lanes out) {
    for (int i = 0; i < rows; ++i)
      for (int w = 0; w < points.width(); ++w) out(i, w) = points(0, w) * g(i, 0) + points(1, w) * g(i, 1);
  };
  double const point[] = {1.0, 1.0}, scale[] = {1.0, 1.0};
  Vector const h = g.col(1) / g.col(1).norm();
  double const left = (g.col(0) - h * h.dot(g.col(0))).norm();
  Sensitivity const s = sensitivity(outputs, rows, point, scale, 1, g.col(1));
  CHECK(std::abs(s.slopes(0, 0)) == doctest::Approx(left).epsilon(1e-9));
  CHECK(std::abs(s.others(0, 0)) < 1e-9);
}

TEST_CASE("a point beside a region that cannot be simulated is said to have no slopes") {
  auto const outputs = [](ConstLanes points, Lanes out) {
    for (int w = 0; w < points.width(); ++w) out(0, w) = points(0, w) > 1 ? std::nan("") : points(0, w);
  };
  double const point[] = {1.0}, scale[] = {1.0};
  CHECK_FALSE(sensitivity(outputs, 1, point, scale, 1).finite);
}

TEST_CASE("slopes of full rank have no null direction") {
  std::vector<LocalSlopes> const sound = draws(4, [](Vector const& value) { return Matrix::Zero(value.size(), 0).eval(); });
  NullSpace const space = find_null_space(sound);
  CHECK(space.draws == 5);
  CHECK(space.directions.empty());
}

TEST_CASE("a group that scales together is named with its exponents") {
  NullSpace const all = find_null_space(draws(5, [](Vector const& value) { return Matrix(value); }));
  REQUIRE(all.directions.size() == 1);
  CHECK(said(all) == "scaling m, c, k, k3 and b together leaves displacement unchanged");

  NullSpace const powers = find_null_space(draws(5, [](Vector const& value) {
    Vector exponents(5);
    exponents << 1, 1, 1, -2, 1.5;
    return Matrix(value.cwiseProduct(exponents));
  }));
  REQUIRE(powers.directions.size() == 1);
  CHECK(said(powers) == "scaling m, c and k by s, k3 by s^(-2) and b by s^(3/2) leaves displacement unchanged for any s");
}

TEST_CASE("two parameters that enter as a product or ratio are named so") {
  NullSpace const ratio = find_null_space(draws(4, [](Vector const& value) {
    Vector exponents = Vector::Zero(4);
    exponents(0) = exponents(2) = 1;
    return Matrix(value.cwiseProduct(exponents));
  }));
  REQUIRE(ratio.directions.size() == 1);
  CHECK(said(ratio) == "m and k enter displacement only as m/k");
  NullSpace const product = find_null_space(draws(4, [](Vector const& value) {
    Vector exponents = Vector::Zero(4);
    exponents(0) = 1, exponents(1) = -2;
    return Matrix(value.cwiseProduct(exponents));
  }));
  REQUIRE(product.directions.size() == 1);
  CHECK(said(product) == "m and c enter displacement only as m*sqrt(c)");
}

TEST_CASE("a sum is named, with the sign and the factor it has") {
  auto const pair = [](double second) {
    return find_null_space(draws(4, [=](Vector const&) {
      Matrix move = Matrix::Zero(4, 1);
      move(2, 0) = 1, move(3, 0) = second;
      return move;
    }));
  };
  REQUIRE(pair(-1).directions.size() == 1);
  CHECK(said(pair(-1)) == "k and k3 are confounded: only k + k3 is determined by displacement");
  CHECK(said(pair(1)) == "k and k3 are confounded: only k - k3 is determined by displacement");
  CHECK(said(pair(-0.5)) == "k and k3 are confounded: only k + 2*k3 is determined by displacement");
}

TEST_CASE("a scaling group and a sum side by side are both named") {
  NullSpace const both = find_null_space(draws(5, [](Vector const& value) {
    Matrix null = Matrix::Zero(5, 2);
    null(0, 0) = value(0), null(1, 0) = value(1);
    null(2, 1) = 1, null(3, 1) = -1;
    return null;
  }));
  REQUIRE(both.directions.size() == 2);
  CHECK(said(both, 0) == "m and c enter displacement only as m/c");
  CHECK(said(both, 1) == "k and k3 are confounded: only k + k3 is determined by displacement");
}

TEST_CASE("a direction that differs from draw to draw is named by what moves most") {
  NullSpace const general = find_null_space(draws(4, [](Vector const& value) {
    Matrix null = Matrix::Zero(4, 1);
    null(0, 0) = 1, null(1, 0) = -value(2);  // dc = -k dm
    return null;
  }));
  REQUIRE(general.directions.size() == 1);
  CHECK(general.directions.front().kind == NullDirection::Kind::general);
  std::string const text = said(general);
  CHECK(text.find("are confounded") != std::string::npos);
  CHECK(text.find(" k ") == std::string::npos);
}

TEST_CASE("a parameter without influence is named alone, and does not hide what else is null") {
  std::vector<LocalSlopes> locals = draws(5, [](Vector const& value) {
    Matrix null = Matrix::Zero(5, 1);
    null(0, 0) = value(0), null(1, 0) = value(1);
    return null;
  });
  for (LocalSlopes& local : locals) local.sensitivity.slopes.col(4).setZero();
  NullSpace const space = find_null_space(locals);
  REQUIRE(space.directions.size() == 2);
  CHECK(said(space, 0) == "b has no influence on displacement with this input");
  CHECK(said(space, 1) == "m and c enter displacement only as m/c");
}

TEST_CASE("what is null at some draws only is not called null, and slopes that are too rough are not judged") {
  std::vector<LocalSlopes> locals = draws(3, [](Vector const& value) { return Matrix(value); });
  locals.front() = draw_at(locals.front().value, random_matrix(3, 77));
  CHECK(find_null_space(locals).directions.empty());
  locals[1].sensitivity.error = 0.1 * locals[1].sensitivity.slopes.colwise().norm().transpose();
  CHECK(find_null_space(locals).draws == 4);
}

TEST_CASE("expected sds and correlations are those of linear regression with a normal prior") {
  // Two columns of length 10 and 3 at 60 degrees, prior sds 1: (J^T J + 1)^-1 by hand.
  LocalSlopes local;
  local.value = local.scale = local.spread = Vector::Ones(2);
  local.sensitivity.finite = true;
  local.sensitivity.slopes = Matrix(2, 2);
  local.sensitivity.slopes << 10, 1.5, 0, 3 * std::sqrt(0.75);
  Expectation const e = expect(local);
  double const a = 101, b = 15, d = 10, determinant = a * d - b * b;
  CHECK(e.shrinkage(0) == relative(std::sqrt(d / determinant), 1e-12));
  CHECK(e.shrinkage(1) == doctest::Approx(std::sqrt(a / determinant)).epsilon(1e-12));
  CHECK(e.correlation(0, 1) == doctest::Approx(-b / std::sqrt(a * d)).epsilon(1e-12));
}
