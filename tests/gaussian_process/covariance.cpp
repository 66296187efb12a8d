// Sums, products and chosen inputs.
#include "gaussian_process/covariance.hpp"

#include <doctest/doctest.h>

#include "gaussian_process/made.hpp"

using namespace sysid;
using namespace sysid::gaussian_process;

namespace {}  // namespace

TEST_CASE("an expression adds and multiplies what its kernels say of the inputs they read") {
  Covariance const whole = (kernel("matern32", {2}) + kernel("constant", {})) * kernel("periodic", {0}) + kernel("linear", {1, 0});
  REQUIRE(whole.parameter_count() == 2 + 1 + 3 + 2);
  std::vector<double> const p = made_parameters(8);
  Eigen::MatrixXd const x = made_inputs(300, 3, 5), z = made_inputs(4, 3, 5, 1);  // more rows than a strip holds
  Eigen::MatrixXd const k = whole.between(x, z, p);
  for (int i : {0, 5, 255, 256, 299})
    for (int j = 0; j < 4; ++j) {
      double const matern = value(*find_kernel("matern32"), Numbers(p).subspan(0, 2), x(i, 2), z(j, 2));
      double const periodic = value(*find_kernel("periodic"), Numbers(p).subspan(3, 3), x(i, 0), z(j, 0));
      double const linear = p[6] * p[6] * x(i, 1) * z(j, 1) + p[7] * p[7] * x(i, 0) * z(j, 0);
      CHECK(k(i, j) == doctest::Approx((matern + p[2] * p[2]) * periodic + linear).epsilon(1e-13));
    }
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(300, 300);
  whole.fill_lower(x, p, lower);
  Eigen::MatrixXd const full = whole.between(x, x, p), expected = full.triangularView<Eigen::Lower>();
  CHECK((lower - expected).norm() < 1e-13 * full.norm());
  CHECK((whole.variances(x, p) - full.diagonal()).norm() < 1e-13 * full.norm());
}

TEST_CASE("the gradient of an expression is that of its values") {
  Covariance const whole = (kernel("matern52", {2}) + kernel("constant", {})) * kernel("periodic", {0}) * kernel("linear", {1}) +
                           kernel("squared_exponential", {1, 0}) + kernel("matern12", {2});
  std::vector<double> const p = made_parameters(whole.parameter_count());
  Eigen::MatrixXd const x = made_inputs(270, 3, 5), root = made_inputs(270, 270, 1, 1);
  Eigen::MatrixXd const weight = root + root.transpose();
  Eigen::VectorXd const expected = differences([&](Numbers q) { return whole.between(x, x, q).cwiseProduct(weight).sum(); }, p);
  CHECK((whole.gradient(x, p, weight) - expected).norm() < 1e-8 * expected.norm());
}

TEST_CASE("hyper-parameters carry their kernel's word, input and powers of units") {
  Covariance const whole = kernel("squared_exponential", {3, 1}) * kernel("oscillator", {0});
  std::vector<HyperParameter> const all = whole.hyper_parameters();
  REQUIRE(all.size() == 7);
  CHECK(all[0].name == "amplitude");
  CHECK(all[0].column == -1);
  CHECK(all[0].unit.output == 1);
  CHECK(all[2].name == "length");
  CHECK(all[2].column == 1);
  CHECK(all[2].unit.input == 1);
  CHECK(all[3].name == "mass");  // [u_F t^2 / y]
  CHECK(all[3].term == 1);
  CHECK(all[3].unit.own == 1);
  CHECK(all[3].unit.input == 2);
  CHECK(all[3].unit.output == -1);
  CHECK_FALSE(whole.is_sum());
  CHECK((kernel("matern12", {0}) + kernel("constant", {})).is_sum());
}
