// Processes of which a value or a derivative is known: against the textbook with the conditions as observations without noise.
#include "gaussian_process/conditions.hpp"

#include <doctest/doctest.h>

#include <numeric>

#include "gaussian_process/dense.hpp"
#include "gaussian_process/jet.hpp"
#include "gaussian_process/made.hpp"
#include "gaussian_process/regression.hpp"
#include "gaussian_process/state_space_model.hpp"
#include "gaussian_process/textbook.hpp"
#include "linear_algebra/lapack.hpp"
#include "relative.hpp"

using namespace sysid;
using namespace sysid::gaussian_process;
using textbook::Matrix, textbook::Real;

namespace {

/// Value and slopes at one point.
std::vector<Condition> rest_at(std::vector<double> const& point) {
  std::vector<Condition> result{{point, -1}};
  for (int d = 0; d < static_cast<int>(point.size()); ++d) result.push_back({point, d});
  return result;
}

/// What is known at a place of one input: f or f'.
struct Functional {
  Real x;
  bool slope;
};

/// Covariances of values and slopes under the squared exponential, written out; by_length: their derivatives in log length.
Matrix squared_exponential(std::vector<Functional> const& left, std::vector<Functional> const& right, Real s, Real l,
                           bool by_length = false) {
  Matrix result = textbook::zeros(left.size(), right.size());
  for (std::size_t i = 0; i < left.size(); ++i)
    for (std::size_t j = 0; j < right.size(); ++j) {
      Real const u = (left[i].x - right[j].x) / l, e = s * s * std::exp(-u * u / 2);
      Real value = by_length ? e * u * u : e;
      if (left[i].slope != right[j].slope) {
        Real const sign = left[i].slope ? -1 : 1;
        value = sign * e * u / l * (by_length ? u * u - 2 : 1);
      } else if (left[i].slope) {
        value = e / (l * l) * (by_length ? -2 * (1 - u * u) + 2 * u * u + (1 - u * u) * u * u : 1 - u * u);
      }
      result[i][j] = value;
    }
  return result;
}

Real trace_of_product(Matrix const& a, Matrix const& b) {
  Real sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) sum += a[i][j] * b[j][i];
  return sum;
}

}  // namespace

TEST_CASE("the numbers that carry derivatives give every kernel's values and derivatives") {
  for (KernelRow const& row : kernels())
    for (int inputs = 1; inputs <= (row.one_input ? 1 : 2); ++inputs) {
      std::vector<int> columns(static_cast<std::size_t>(inputs));
      std::iota(columns.begin(), columns.end(), 0);
      Covariance const covariance(row, columns);
      std::vector<double> parameters = made_parameters(covariance.parameter_count());
      for (double const first : {parameters.front(), 0.02, 40.0}) {  // an oscillator of mass 0.02 is overdamped
        if (row.name == "oscillator") parameters.front() = first;
        CAPTURE(row.name);
        CAPTURE(first);
        Eigen::MatrixXd const x = made_inputs(6, inputs, 3), z = made_inputs(6, inputs, 3, 1);
        for (Eigen::Index i = 0; i < 6; ++i) {
          auto const at = [&](Eigen::MatrixXd const& points, int moved, double by, int derivative) {
            Condition one{{}, derivative};
            for (int d = 0; d < inputs; ++d) one.point.push_back(points(i, d) + (d == moved ? by : 0));
            return one;
          };
          double const value = covariance.between(x.row(i), z.row(i), parameters)(0, 0);
          CHECK(covariance.between(at(x, -1, 0, -1), at(z, -1, 0, -1), parameters) ==
                doctest::Approx(value).epsilon(1e-13).scale(0));
          double const step = 1e-3;
          auto const slope = [&](auto const& f) { return (8 * (f(step) - f(-step)) - (f(2 * step) - f(-2 * step))) / (12 * step); };
          for (int a = -1; a < inputs; ++a)
            for (int b = -1; b < inputs; ++b) {
              if (!row.differentiable && (a >= 0 || b >= 0)) continue;
              double const found = covariance.between(at(x, -1, 0, a), at(z, -1, 0, b), parameters);
              if (a >= 0)
                CHECK(found ==
                      relative(slope([&](double by) { return covariance.between(at(x, a, by, -1), at(z, -1, 0, b), parameters); }),
                               1e-7));
              else if (b >= 0)
                CHECK(found ==
                      relative(slope([&](double by) { return covariance.between(at(x, -1, 0, a), at(z, b, by, -1), parameters); }),
                               1e-7));
              Eigen::VectorXd const expected =
                  differences([&](Numbers p) { return covariance.between(at(x, -1, 0, a), at(z, -1, 0, b), p); }, parameters, 1e-3);
              for (int p = 0; p < covariance.parameter_count(); ++p)
                CHECK(covariance.between(at(x, -1, 0, a), at(z, -1, 0, b), parameters, p) ==
                      doctest::Approx(expected[p]).epsilon(1e-7).scale(1));  // differences of numbers of about 1
            }
          // The variance of a slope is the curvature where two points meet.
          if (!row.differentiable) continue;
          double const near = 1e-4;
          double const drop = covariance.between(at(x, -1, 0, -1), at(x, -1, 0, -1), parameters) -
                              2 * covariance.between(at(x, -1, 0, -1), at(x, 0, near, -1), parameters) +
                              covariance.between(at(x, 0, near, -1), at(x, 0, near, -1), parameters);
          // A Matérn 3/2 has a third derivative of either side: its quotient is off by a step over its length.
          CHECK(covariance.between(at(x, -1, 0, 0), at(x, -1, 0, 0), parameters) == relative(drop / (near * near), 2e-3));
        }
      }
    }
}

TEST_CASE("likelihood, gradient and posterior with a value and a slope known equal the textbook's to 1e-10") {
  Observations o;
  o.inputs = made_inputs(25, 1, 6);
  o.values = made_values(o.inputs, 0.1);
  double const s = 1.3, l = 0.9, noise = 0.2, point = 0.4;
  std::vector<double> const parameters = {s, l, noise};
  Covariance const covariance = kernel("squared_exponential").conditioned(rest_at({point}));

  // p(y | c = 0) = p(y, c = 0)/p(c = 0), the conditions observed beside the data.
  std::vector<Functional> conditions{{point, false}, {point, true}}, all, data;
  for (double const x : o.inputs.reshaped()) data.push_back({x, false});
  all = data;
  all.insert(all.end(), conditions.begin(), conditions.end());
  std::size_t const n = data.size();
  Matrix joint = squared_exponential(all, all, s, l);
  for (std::size_t i = 0; i < n; ++i) joint[i][i] += Real(noise) * noise;
  Real of_joint = 0, of_conditions = 0;
  Matrix const inverted = textbook::inverse(joint, of_joint),
               own = textbook::inverse(squared_exponential(conditions, conditions, s, l), of_conditions);
  Matrix y = textbook::zeros(n + 2, 1);
  for (std::size_t i = 0; i < n; ++i) y[i][0] = o.values[static_cast<Eigen::Index>(i)];
  Matrix const alpha = textbook::product(inverted, y);
  Real const quadratic = textbook::product(textbook::transposed(y), alpha)[0][0];
  Real const expected = -0.5L * quadratic - 0.5L * (of_joint - of_conditions) - 0.5L * Real(n) * std::log(2 * std::acos(Real(-1)));
  Marginal const found = dense_marginal(covariance, o, parameters, true);
  REQUIRE(found.outcome == Outcome::fine);
  CHECK(found.log_likelihood == doctest::Approx(static_cast<double>(expected)).epsilon(1e-10).scale(0));

  Matrix const outer = textbook::product(alpha, textbook::transposed(alpha));
  Matrix weight = outer;
  for (std::size_t i = 0; i < n + 2; ++i)
    for (std::size_t j = 0; j < n + 2; ++j) weight[i][j] -= inverted[i][j];
  Matrix by_amplitude = squared_exponential(all, all, s, l), of_own = squared_exponential(conditions, conditions, s, l);
  Matrix const by_length = squared_exponential(all, all, s, l, true),
               own_length = squared_exponential(conditions, conditions, s, l, true);
  Real by_noise = 0;
  for (std::size_t i = 0; i < n; ++i) by_noise += weight[i][i] * Real(noise) * noise;
  Real const gradient[] = {trace_of_product(weight, by_amplitude) + trace_of_product(own, of_own),
                           0.5L * trace_of_product(weight, by_length) + 0.5L * trace_of_product(own, own_length), by_noise};
  for (int p = 0; p < 3; ++p) CHECK(found.gradient[p] == doctest::Approx(static_cast<double>(gradient[p])).epsilon(1e-10).scale(0));

  DensePosterior const posterior(covariance, o, parameters);
  Places places;
  places.inputs = made_inputs(7, 1, 9, 3);
  std::vector<Functional> there;
  for (double const x : places.inputs.reshaped()) there.push_back({x, false});
  Matrix const cross = squared_exponential(there, all, s, l), gain = textbook::product(cross, inverted);
  Matrix const mean = textbook::product(gain, y), taken = textbook::product(gain, textbook::transposed(cross)),
               prior = squared_exponential(there, there, s, l);
  Prediction const prediction = posterior.predict(places);
  Eigen::MatrixXd const spread = posterior.covariance(places);
  for (std::size_t i = 0; i < 7; ++i) {
    auto const row = static_cast<Eigen::Index>(i);
    CHECK(std::fabs(prediction.mean[row] - static_cast<double>(mean[i][0])) < 1e-10);
    for (std::size_t j = 0; j < 7; ++j)
      CHECK(std::fabs(spread(row, static_cast<Eigen::Index>(j)) - static_cast<double>(prior[i][j] - taken[i][j])) < 1e-10);
    CHECK(std::fabs(prediction.variance[row] - static_cast<double>(prior[i][i] - taken[i][i])) < 1e-10);
  }
}

TEST_CASE("gradients with conditions are those of the likelihood, for sums, products and conditions of their own") {
  Observations o;
  o.inputs = made_inputs(30, 3, 6);
  o.values = made_values(o.inputs, 0.1);
  o.columns.resize(30, 1);
  o.columns.col(0).setOnes();
  o.prior_mean = Eigen::VectorXd::Constant(1, 0.3);
  o.prior_sd = Eigen::VectorXd::Constant(1, 2);
  Covariance const first = (kernel("matern52", {0, 1}) + kernel("periodic", {0}) * kernel("squared_exponential", {1}))
                               .conditioned(rest_at({0.2, -0.4})),
                   second = kernel("matern32", {2}).conditioned({{{0, 0, 0.7}, -1}, {{0, 0, -1}, 2}}),
                   rough = kernel("matern12", {0}).conditioned({{{1.0}, -1}, {{-1.0}, -1}}),
                   line = (kernel("linear", {0}) + kernel("constant", {})).conditioned({{{0.5}, -1}});
  for (Covariance const& covariance : {first, second, first + second, second + kernel("constant", {}) + rough, line + second}) {
    std::vector<double> parameters = made_parameters(covariance.parameter_count());
    parameters.push_back(0.15);
    Marginal const found = dense_marginal(covariance, o, parameters, true);
    REQUIRE(found.outcome == Outcome::fine);
    Eigen::VectorXd const expected =
        differences([&](Numbers p) { return dense_marginal(covariance, o, p, false).log_likelihood; }, parameters);
    CHECK((found.gradient - expected).norm() < 1e-8 * (1 + expected.norm()));
    CHECK(found.log_likelihood == doctest::Approx(textbook::log_marginal_likelihood(covariance, o, parameters)).epsilon(1e-11));
    CHECK(!has_state_space(covariance));
  }
}

TEST_CASE("of addends each has its own conditions") {
  Eigen::MatrixXd const x = made_inputs(9, 2, 4);
  Covariance const one = kernel("matern52", {0}).conditioned(rest_at({0.1})), other = kernel("squared_exponential", {1});
  std::vector<double> const parameters = {0.9, 1.1, 1.4, 0.7};
  Eigen::MatrixXd const sum = (one + other).between(x, x, parameters),
                        apart = one.between(x, x, Numbers(parameters).first(2)) + other.between(x, x, Numbers(parameters).last(2)),
                        turned = (other + one).between(x, x, std::vector<double>{1.4, 0.7, 0.9, 1.1});
  CHECK((sum - apart).norm() < 1e-14);
  CHECK((sum - turned).norm() < 1e-14);
  CHECK(((one + other).variances(x, parameters) - sum.diagonal()).norm() < 1e-14);
}

TEST_CASE("functions drawn vanish at the point and are flat there, and elsewhere they are not") {
  for (char const* const name : {"squared_exponential", "matern52", "matern32", "periodic", "oscillator"}) {
    CAPTURE(name);
    Covariance const covariance = kernel(name).conditioned(rest_at({0}));
    std::vector<double> const parameters = made_parameters(covariance.parameter_count());
    double const h = 1e-3;
    Eigen::MatrixXd x(4, 1);
    x << 0, h, -h, 1;
    Eigen::MatrixXd const k = covariance.between(x, x, parameters);
    double const prior = covariance.between({{0}, -1}, {{0}, -1}, parameters),
                 slope = covariance.between({{0}, 0}, {{0}, 0}, parameters);
    CHECK(std::fabs(k(0, 0)) < 1e-14 * prior);
    // The sd of the slope over 2 h: of order h^2 with a third derivative, and sqrt(h) where there is but one.
    bool const rough = std::string(name) == "matern32" || std::string(name) == "oscillator";
    double const left = (k(1, 1) - 2 * k(1, 2) + k(2, 2)) / (4 * h * h * slope);
    CHECK(left < (rough ? 10 * h : 1e-8));
    CHECK(k(3, 3) > 1e-3 * prior);

    Eigen::MatrixXd grid = Eigen::VectorXd::LinSpaced(41, -0.2, 0.2);
    Eigen::MatrixXd factor = covariance.between(grid, grid, parameters);
    factor.diagonal().array() += 1e-10 * prior;
    REQUIRE(lapack::cholesky(factor));
    Stream stream({.seed = 4, .purpose = Purpose::test});
    for (int draw = 0; draw < 20; ++draw) {
      Eigen::VectorXd normal(41);
      for (double& one : normal) one = stream.normal();
      Eigen::VectorXd const f = factor.triangularView<Eigen::Lower>() * normal;
      CHECK(std::fabs(f[20]) < 1e-4 * std::sqrt(prior));
      CHECK(std::fabs(f[21] - f[19]) < 0.02 * 0.35 * std::sqrt(slope));  // 0.02 sqrt(slope) is one sd of a free one
    }
  }
}

TEST_CASE("a condition that says nothing new changes nothing") {
  Eigen::MatrixXd const x = made_inputs(9, 1, 4);
  std::vector<double> const parameters = {0.9, 1.1};
  Covariance const once = kernel("matern52").conditioned(rest_at({0.1})),
                   twice = kernel("matern52").conditioned({{{0.1}, -1}, {{0.1}, -1}, {{0.1}, 0}, {{0.1}, 0}});
  CHECK((once.between(x, x, parameters) - twice.between(x, x, parameters)).norm() < 1e-14);
  // A line through the origin vanishes there anyway; of one that is flat, too, nothing is left.
  Covariance const line = kernel("linear");
  std::vector<double> const slope = {1.7};
  CHECK((line.conditioned({{{0.0}, -1}}).between(x, x, slope) - line.between(x, x, slope)).norm() == 0);
  CHECK(line.conditioned(rest_at({0})).between(x, x, slope).norm() < 1e-14);
}

TEST_CASE("what conditions hold for is not filtered") {
  Observations o;
  o.inputs = Eigen::VectorXd::LinSpaced(320, 0, 10);
  o.values = made_values(o.inputs, 0.1);
  std::vector<double> const parameters = {0.9, 1.1, 0.2};
  Covariance const covariance = kernel("matern32").conditioned(rest_at({0}));
  CHECK(marginal(covariance, o, parameters, false).log_likelihood ==
        dense_marginal(covariance, o, parameters, false).log_likelihood);
}
