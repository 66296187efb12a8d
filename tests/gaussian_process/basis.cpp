// The reduced-rank expansion against the kernels it stands for.
#include "gaussian_process/basis.hpp"

#include <doctest/doctest.h>

#include "expression/pull_back.hpp"
#include "gaussian_process/covariance.hpp"
#include "gaussian_process/made.hpp"

using namespace sysid;
using namespace sysid::gaussian_process;

namespace {

/// What multiplies each standard normal coefficient at points [N x D]: [N x size]. The expansion is linear in the coefficients, so
/// these are its derivatives by them.
Eigen::MatrixXd functions(KernelRow const& row, Numbers parameters, Box const& box, Eigen::MatrixXd const& points) {
  Graph graph;
  std::vector<NodeId> constants, inputs, coefficients;
  for (double const parameter : parameters) constants.push_back(graph.constant(parameter));
  for (int d = 0; d < points.cols(); ++d) inputs.push_back(graph.leaf(LeafKind::input, d));
  int const size = expansion_size(row, box.counts);
  for (int j = 0; j < size; ++j) coefficients.push_back(graph.leaf(LeafKind::parameter, j));
  NodeId const value = expansion(row, graph, constants, inputs, coefficients, box);
  NodeId const one = graph.constant(1);
  std::vector<NodeId> const derivatives = pull_back(graph, {&value, 1}, {&one, 1}, coefficients);
  Eigen::MatrixXd result(points.rows(), size);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    std::vector<double> const row_of_point = graph.evaluate(derivatives, [&](NodeId leaf) { return points(i, graph[leaf].index); });
    result.row(i) = Eigen::Map<Eigen::RowVectorXd const>(row_of_point.data(), size);
  }
  return result;
}

/// The largest error of the expanded covariance between points, over the largest variance.
double error(char const* name, Numbers parameters, Box const& box, Eigen::MatrixXd const& points) {
  std::vector<int> columns;
  for (int d = 0; d < points.cols(); ++d) columns.push_back(d);
  Eigen::MatrixXd const exact = kernel(name, columns).between(points, points, parameters);
  Eigen::MatrixXd const own = functions(*find_kernel(name), parameters, box, points);
  return (own * own.transpose() - exact).cwiseAbs().maxCoeff() / exact.diagonal().maxCoeff();
}

}  // namespace

TEST_CASE("basis functions are orthonormal on their box") {
  Graph graph;
  NodeId const x = graph.leaf(LeafKind::input);
  Basis const basis({{2.0}, {3.0}, {6}});
  std::vector<NodeId> values;
  for (int j = 0; j < 6; ++j) {
    std::vector<NodeId> weights(6, graph.constant(0));
    weights[static_cast<std::size_t>(j)] = graph.constant(1);
    values.push_back(basis.sum(graph, {&x, 1}, weights));
  }
  auto const at = [&](double place) {
    std::vector<double> const found = graph.evaluate(values, [&](NodeId) { return place; });
    return Eigen::VectorXd(Eigen::Map<Eigen::VectorXd const>(found.data(), 6));
  };
  int const count = 4000;  // midpoints
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(6, 6);
  for (int i = 0; i < count; ++i) {
    Eigen::VectorXd const one = at(-1 + (i + 0.5) * 6.0 / count);
    gram += one * one.transpose() * (6.0 / count);
  }
  CHECK((gram - Eigen::MatrixXd::Identity(6, 6)).norm() < 1e-10);
  CHECK(at(-1).norm() < 1e-12);  // zero at the faces
  CHECK(at(5).norm() < 1e-12);
}

TEST_CASE("the expansion converges to the kernel, in one input and two") {
  Eigen::MatrixXd const points = made_inputs(30, 1, 4).array() + 1;  // within 2 of the centre, the faces at 12
  std::vector<double> const parameters = {1.3, 0.9};
  CHECK(error("squared_exponential", parameters, {{1}, {12}, {80}}, points) < 1e-10);
  CHECK(error("squared_exponential", parameters, {{1}, {12}, {20}}, points) > 1e-3);
  // A density that falls as w^-6 leaves a rest of the order of count^-5.
  double const coarse = error("matern52", parameters, {{1}, {12}, {100}}, points);
  double const fine = error("matern52", parameters, {{1}, {12}, {200}}, points);
  CHECK(coarse < 1e-3);
  CHECK(fine < coarse / 16);

  Eigen::MatrixXd plane = made_inputs(12, 2, 4);
  plane.col(1).array() += 5;
  CHECK(error("squared_exponential", std::vector<double>{1.3, 0.9, 1.4}, {{0, 5}, {10, 14}, {70, 60}}, plane) < 1e-9);
}

TEST_CASE("a kernel of finite rank is its own expansion") {
  Eigen::MatrixXd const plane = made_inputs(12, 2, 4);
  CHECK(error("linear", std::vector<double>{1.3, 0.4}, {{0, 0}, {1, 1}, {3, 3}}, plane) < 1e-14);
  CHECK(error("constant", std::vector<double>{1.3}, {{0, 0}, {1, 1}, {3, 3}}, plane) < 1e-14);
}

TEST_CASE("which kernels have an expansion") {
  for (char const* name : {"squared_exponential", "matern12", "matern32", "matern52", "linear", "constant"})
    CHECK(has_expansion(*find_kernel(name)));
  CHECK_FALSE(has_expansion(*find_kernel("periodic")));
}
