// The table of kernels, and how wide a population is.
#include "inference/abc/kernel.hpp"

#include <algorithm>

#include "linear_algebra/decompositions.hpp"

namespace sysid::abc {

std::unique_ptr<Kernel> make_gaussian(Plan const&, ConstLanes, std::span<double const>, Width const&);
std::unique_ptr<Kernel> make_component_gaussian(Plan const&, ConstLanes, std::span<double const>, Width const&);
std::unique_ptr<Kernel> make_uniform(Plan const&, ConstLanes, std::span<double const>, Width const&);
std::unique_ptr<Kernel> make_nearest_neighbours(Plan const&, ConstLanes, std::span<double const>, Width const&);

namespace {

constexpr KernelRow kernel_rows[] = {
    {"gaussian", 2, make_gaussian},
    {"component_gaussian", 2, make_component_gaussian},
    {"uniform", 1, make_uniform},
    {"nearest_neighbours", 1, make_nearest_neighbours},
};

}  // namespace

std::span<KernelRow const> kernels() { return kernel_rows; }

KernelRow const* find_kernel(std::string_view name) {
  auto const row =
      std::find_if(std::begin(kernel_rows), std::end(kernel_rows), [&](KernelRow const& each) { return each.name == name; });
  return row == std::end(kernel_rows) ? nullptr : row;
}

Width width_of(ConstLanes at, std::span<double const> weight, Width const& last) {
  int const dimension = at.rows(), count = at.width();
  if (count < dimension + 2) return last;
  Width width{Eigen::MatrixXd::Zero(dimension, dimension), Eigen::VectorXd::Zero(dimension)};
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(dimension);
  for (int d = 0; d < dimension; ++d) {
    auto const row = at.row(d);
    for (std::size_t j = 0; j < row.size(); ++j) mean[d] += weight[j] * row[j];
    auto const [low, high] = std::minmax_element(row.begin(), row.end());
    width.range[d] = *high - *low;
  }
  for (int d = 0; d < dimension; ++d)
    for (int e = 0; e <= d; ++e) {
      double sum = 0;
      for (int j = 0; j < count; ++j) sum += weight[static_cast<std::size_t>(j)] * (at(d, j) - mean[d]) * (at(e, j) - mean[e]);
      width.covariance(d, e) = width.covariance(e, d) = sum;
    }
  bool const wide = dimension == 0 || width.range.minCoeff() > 0;
  return wide && cholesky(width.covariance) ? width : last;
}

}  // namespace sysid::abc
