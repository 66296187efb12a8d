// Inputs, observations and hyper-parameters that several tests use, and derivatives by differences.
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/numeric/random.hpp"
#include "gaussian_process/covariance.hpp"

namespace sysid::gaussian_process {

/// Of these columns of the inputs.
inline Covariance kernel(char const* name, std::vector<int> columns = {0}) { return {*find_kernel(name), std::move(columns)}; }

inline Eigen::MatrixXd made_inputs(Eigen::Index count, Eigen::Index columns, double width, std::uint64_t index = 0) {
  Stream stream({.seed = 11, .purpose = Purpose::test, .index = index});
  Eigen::MatrixXd result(count, columns);
  for (double& one : result.reshaped()) one = width * (stream.uniform() - 0.5);
  return result;
}

inline Eigen::VectorXd made_values(Eigen::MatrixXd const& inputs, double noise, std::uint64_t index = 0) {
  Stream stream({.seed = 12, .purpose = Purpose::test, .index = index});
  Eigen::VectorXd result(inputs.rows());
  for (Eigen::Index i = 0; i < inputs.rows(); ++i) {
    double sum = 0;
    for (Eigen::Index d = 0; d < inputs.cols(); ++d) sum += std::sin((1 + 0.3 * static_cast<double>(d)) * inputs(i, d));
    result[i] = sum + noise * stream.normal();
  }
  return result;
}

/// Different from 1 and from each other.
inline std::vector<double> made_parameters(int count) {
  std::vector<double> result;
  for (int j = 0; j < count; ++j) result.push_back(0.7 + 0.23 * j);
  return result;
}

/// The derivative of f in the logarithm of each parameter, by central differences of fourth order.
inline Eigen::VectorXd differences(std::function<double(Numbers)> const& f, std::vector<double> const& at, double step = 3e-4) {
  Eigen::VectorXd result(static_cast<Eigen::Index>(at.size()));
  for (std::size_t j = 0; j < at.size(); ++j) {
    auto const moved = [&](double by) {
      std::vector<double> there = at;
      there[j] *= std::exp(by);
      return f(there);
    };
    result[static_cast<Eigen::Index>(j)] = (8 * (moved(step) - moved(-step)) - (moved(2 * step) - moved(-2 * step))) / (12 * step);
  }
  return result;
}

/// k(x, z) of one kernel on one input.
inline double value(KernelRow const& row, Numbers parameters, double x, double z) {
  double const* const left[] = {&x};
  double const right[] = {z};
  double out = 0;
  row.values({left, right, 1}, parameters, &out);
  return out;
}

}  // namespace sysid::gaussian_process
