// The reduced-rank expansion against the kernels it stands for.
#include "gaussian_process/basis.hpp"

#include <doctest/doctest.h>

#include "gaussian_process/made.hpp"

using namespace sysid;
using namespace sysid::gaussian_process;

namespace {

Covariance kernel(char const* name, std::vector<int> columns = {0}) { return {*find_kernel(name), std::move(columns)}; }

/// The largest error of the expanded covariance between points, over the largest variance.
double error(Covariance const& covariance, Numbers parameters, Basis const& basis, Eigen::MatrixXd const& points) {
  Eigen::MatrixXd const functions = basis.functions(points), exact = covariance.between(points, points, parameters);
  Eigen::MatrixXd const sum = functions * spectral_weights(covariance, parameters, basis).asDiagonal() * functions.transpose();
  return (sum - exact).cwiseAbs().maxCoeff() / exact.diagonal().maxCoeff();
}

}  // namespace

TEST_CASE("basis functions are orthonormal on their box") {
  Basis const basis(Eigen::VectorXd::Constant(1, 2.0), Eigen::VectorXd::Constant(1, 3.0), {6});
  int const count = 4000;  // midpoints
  Eigen::VectorXd const points = Eigen::VectorXd::LinSpaced(count, -1 + 3.0 / count, 5 - 3.0 / count);
  Eigen::MatrixXd const functions = basis.functions(points);
  Eigen::MatrixXd const gram = functions.transpose() * functions * (6.0 / count);
  CHECK((gram - Eigen::MatrixXd::Identity(6, 6)).norm() < 1e-10);
  CHECK(basis.functions(Eigen::VectorXd::Constant(1, -1.0)).norm() < 1e-12);  // zero at the faces
}

TEST_CASE("the expansion converges to the kernel, in one input and two") {
  Eigen::VectorXd const one = Eigen::VectorXd::Constant(1, 1.0);
  Eigen::MatrixXd const points = made_inputs(30, 1, 4).array() + 1;  // within 2 of the centre, the faces at 12
  std::vector<double> const parameters = {1.3, 0.9};
  CHECK(error(kernel("squared_exponential"), parameters, {one, 12 * one, {80}}, points) < 1e-10);
  CHECK(error(kernel("squared_exponential"), parameters, {one, 12 * one, {20}}, points) > 1e-3);
  // A density that falls as w^-6 leaves a rest of the order of count^-5.
  double const coarse = error(kernel("matern52"), parameters, {one, 12 * one, {100}}, points);
  double const fine = error(kernel("matern52"), parameters, {one, 12 * one, {200}}, points);
  CHECK(coarse < 1e-3);
  CHECK(fine < coarse / 16);
  Covariance const sum = kernel("squared_exponential") + kernel("matern52");
  CHECK(error(sum, std::vector<double>{1.3, 0.9, 0.4, 1.1}, {one, 12 * one, {200}}, points) < 1e-4);

  Eigen::VectorXd const centre = Eigen::Vector2d(0, 5), half = Eigen::Vector2d(10, 14);
  Eigen::MatrixXd plane = made_inputs(30, 2, 4);
  plane.col(1).array() += 5;
  CHECK(error(kernel("squared_exponential", {0, 1}), std::vector<double>{1.3, 0.9, 1.4}, {centre, half, {70, 60}}, plane) < 1e-9);
}

TEST_CASE("what has no spectral density is known beforehand") {
  CHECK(has_spectral_density(kernel("oscillator") + kernel("matern12")));
  CHECK_FALSE(has_spectral_density(kernel("periodic")));
  CHECK_FALSE(has_spectral_density(kernel("matern12") + kernel("constant", {})));
  CHECK_FALSE(has_spectral_density(kernel("matern12", {0}) + kernel("matern12", {1})));
  CHECK_FALSE(has_spectral_density(kernel("matern12") * kernel("matern32")));
}
