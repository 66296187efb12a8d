// Checks over the table of kernels: a new row is tested at birth.
#include <doctest/doctest.h>

#include <complex>
#include <numbers>

#include "gaussian_process/made.hpp"
#include "linear_algebra/lapack.hpp"
#include "relative.hpp"

using namespace sysid;
using namespace sysid::gaussian_process;

namespace {

Covariance on_inputs(KernelRow const& row, int inputs) {
  std::vector<int> columns;
  for (int d = 0; d < inputs; ++d) columns.push_back(d);
  return {row, columns};
}

std::vector<double> parameters_of(KernelRow const& row, int inputs) { return made_parameters(hyper_parameter_count(row, inputs)); }

}  // namespace

TEST_CASE("kernels are found by name, and names are unique") {
  for (KernelRow const& row : kernels()) CHECK(find_kernel(row.name) == &row);
  CHECK(find_kernel("gaussian") == nullptr);
}

TEST_CASE("every kernel is symmetric and positive semidefinite") {
  for (KernelRow const& row : kernels())
    for (int inputs = 1; inputs <= (row.one_input ? 1 : 3); ++inputs) {
      CAPTURE(row.name);
      CAPTURE(inputs);
      Eigen::MatrixXd const x = made_inputs(30, inputs, 8);
      std::vector<double> const parameters = parameters_of(row, inputs);
      Eigen::MatrixXd const k = on_inputs(row, inputs).between(x, x, parameters);
      CHECK((k - k.transpose()).norm() < 1e-14 * k.norm());
      Eigen::MatrixXd factored = k + 1e-12 * k.diagonal().mean() * Eigen::MatrixXd::Identity(30, 30);
      CHECK(lapack::cholesky(factored));
    }
}

TEST_CASE("every kernel's gradient is that of its values") {
  for (KernelRow const& row : kernels())
    for (int inputs = 1; inputs <= (row.one_input ? 1 : 3); ++inputs) {
      CAPTURE(row.name);
      CAPTURE(inputs);
      Eigen::MatrixXd const x = made_inputs(20, inputs, 6), root = made_inputs(20, 20, 1, 1);
      Eigen::MatrixXd const weight = root + root.transpose();
      Covariance const covariance = on_inputs(row, inputs);
      std::vector<double> const parameters = parameters_of(row, inputs);
      Eigen::VectorXd const expected =
          differences([&](Numbers p) { return covariance.between(x, x, p).cwiseProduct(weight).sum(); }, parameters);
      Eigen::VectorXd const found = covariance.gradient(x, parameters, weight);
      CHECK((found - expected).norm() < 1e-8 * (1 + expected.norm()));
    }
}

TEST_CASE("the known values of each kernel") {
  double const x = 1.3, z = 0.4, r = (x - z) / 2;
  auto const at = [&](char const* name, std::vector<double> const& p) { return value(*find_kernel(name), p, x, z); };
  CHECK(at("squared_exponential", {3, 2}) == doctest::Approx(9 * std::exp(-r * r / 2)).epsilon(1e-14));
  CHECK(at("matern12", {3, 2}) == doctest::Approx(9 * std::exp(-r)).epsilon(1e-14));
  CHECK(at("matern32", {3, 2}) == doctest::Approx(9 * (1 + std::sqrt(3) * r) * std::exp(-std::sqrt(3) * r)).epsilon(1e-14));
  CHECK(at("matern52", {3, 2}) ==
        doctest::Approx(9 * (1 + std::sqrt(5) * r + 5 * r * r / 3) * std::exp(-std::sqrt(5) * r)).epsilon(1e-14));
  double const sine = std::sin(std::numbers::pi * (x - z) / 5);
  CHECK(at("periodic", {3, 2, 5}) == doctest::Approx(9 * std::exp(-2 * sine * sine / 4)).epsilon(1e-14));
  CHECK(at("linear", {3}) == doctest::Approx(9 * x * z).epsilon(1e-14));
  CHECK(at("constant", {3}) == 9);
}

TEST_CASE("state-space forms give the kernel's values and exact derivatives") {
  for (KernelRow const& row : kernels()) {
    if (row.state_space == nullptr) continue;
    CAPTURE(row.name);
    int const d = row.state_space->dimension, count = hyper_parameter_count(row, 1);
    std::vector<double> parameters = parameters_of(row, 1);
    for (double const first : {0.7, 0.02, 40.0}) {  // an oscillator of mass 0.02 is overdamped
      parameters[0] = first;
      CAPTURE(first);
      using Matrix = Eigen::MatrixXd;
      auto const stationary = [&](Numbers p, Matrix* derivatives = nullptr) {
        Matrix result(d, d), changes(d * d, count);
        row.state_space->stationary(p, result.data(), changes.data());
        if (derivatives != nullptr) *derivatives = changes;
        return result;
      };
      auto const transition = [&](Numbers p, double step, Matrix* derivatives = nullptr) {
        Matrix result(d, d), changes(d * d, count);
        row.state_space->transition(p, step, result.data(), changes.data());
        if (derivatives != nullptr) *derivatives = changes;
        return result;
      };
      Matrix const p = stationary(parameters);
      CHECK((transition(parameters, 0) - Matrix::Identity(d, d)).norm() < 1e-15);
      for (double const step : {0.03, 0.4, 2.5}) {
        Matrix const a = transition(parameters, step);
        CHECK((a * p)(0, 0) == relative(value(row, parameters, step, 0), 1e-12));
        CHECK((transition(parameters, 0.3 * step) * transition(parameters, 0.7 * step) - a).norm() < 1e-13 * (1 + a.norm()));
        Matrix changes;
        transition(parameters, step, &changes);
        for (int i = 0; i < d * d; ++i) {
          auto const expected = differences([&](Numbers q) { return transition(q, step)(i % d, i / d); }, parameters, 1e-3);
          CHECK((changes.row(i).transpose() - expected).norm() < 1e-8 * (1 + changes.norm()));
        }
      }
      Matrix changes;
      stationary(parameters, &changes);
      for (int i = 0; i < d * d; ++i) {
        auto const expected = differences([&](Numbers q) { return stationary(q)(i % d, i / d); }, parameters, 1e-3);
        CHECK((changes.row(i).transpose() - expected).norm() < 1e-9 * (1 + changes.norm()));
      }
    }
  }
}

TEST_CASE("spectral densities are the Fourier transforms of their kernels") {
  for (KernelRow const& row : kernels()) {
    if (row.spectral_root == nullptr) continue;
    CAPTURE(row.name);
    std::vector<double> const parameters = parameters_of(row, 1);
    for (double const frequency : {0.0, 0.8, 3.1}) {
      // 2 times the integral of k(t) cos(w t) over t > 0, by Simpson's rule.
      double const step = 2e-3, end = 60;
      int const count = static_cast<int>(end / step);
      double sum = 0;
      for (int i = 0; i <= count; ++i) {
        double const t = i * step, weight = i == 0 || i == count ? 1 : i % 2 == 1 ? 4 : 2;
        sum += weight * value(row, parameters, t, 0) * std::cos(frequency * t);
      }
      double const expected = 2 * sum * step / 3;
      Graph graph;
      std::vector<NodeId> constants;
      for (double const parameter : parameters) constants.push_back(graph.constant(parameter));
      double const root = graph.constant_value(row.spectral_root(graph, constants, Numbers(&frequency, 1))).value();
      CHECK(root * root == relative(expected, 1e-9));
    }
  }
}

TEST_CASE("the oscillator's covariance is the integral of its impulse response against itself") {
  struct Case {
    double mass, damping, stiffness;
  };
  // Lightly damped, nearly critical on either side, exactly critical, overdamped, strongly overdamped.
  for (auto const& [mass, damping, stiffness] :
       {Case{1, 0.4, 9}, Case{1, 1.99999, 1}, Case{1, 2.00001, 1}, Case{1, 2, 1}, Case{2, 7, 3}, Case{0.01, 3, 2}}) {
    CAPTURE(damping);
    // h by its characteristic roots, which differ; critical damping is approached from both sides by moving it a little.
    std::complex<double> const root = std::sqrt(std::complex<double>(damping * damping - 4 * mass * stiffness * (1 - 1e-9)));
    std::complex<double> const fast = (-damping - root) / (2 * mass), slow = (-damping + root) / (2 * mass);
    auto const impulse = [&](double t) { return ((std::exp(slow * t) - std::exp(fast * t)) / (mass * (slow - fast))).real(); };
    double const intensity = 0.7;
    for (double const lag : {0.0, 0.1, 0.9, 4.0}) {
      CAPTURE(lag);
      // The substitution t = u^2 resolves the fast root near 0.
      double const end = 8, step = 5e-4;
      int const count = static_cast<int>(end / step);
      double sum = 0;
      for (int i = 0; i <= count; ++i) {
        double const u = i * step, weight = i == 0 || i == count ? 1 : i % 2 == 1 ? 4 : 2;
        sum += weight * 2 * u * impulse(u * u) * impulse(u * u + lag);
      }
      double const parameters[] = {mass, damping, stiffness, intensity};
      CHECK(value(*find_kernel("oscillator"), parameters, 3 - lag, 3) == relative(intensity * sum * step / 3, 2e-7));
    }
  }
}
