// Rows of several records as one problem, and whether what is left of it is white.
#include "regression/column/evaluation.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>

#include "core/numeric/random.hpp"
#include "expression/function.hpp"
#include "regression/error_concerns.hpp"

using namespace sysid;
using namespace sysid::regression;

TEST_CASE("blocks of rows follow one another, the known side before the terms") {
  Eigen::MatrixXd const all{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  Columns const columns = stacked({rows_at(all, {0, 2}), Eigen::MatrixXd(0, 3), rows_at(all, {1})}, 2);
  CHECK(columns.known == Eigen::VectorXd{{1, 7, 4}});
  CHECK(columns.terms == Eigen::MatrixXd{{2, 3}, {8, 9}, {5, 6}});
  CHECK(stacked({}, 2).terms.cols() == 2);
}

TEST_CASE("columns of powers and functions have the bits of one row after the other") {
  Graph graph;
  NodeId const x = graph.leaf(LeafKind::unknown, 0), y = graph.leaf(LeafKind::unknown, 1);
  std::vector<NodeId> const roots = {graph.power(x, y), graph.call(log_function, x), graph.add(graph.multiply(x, y), y)};
  std::vector<double> a, b;  // more than a block, and no whole number of vectors
  Stream stream({.seed = 4, .purpose = Purpose::test, .index = 0, .step = 0});
  for (int i = 0; i < 275; ++i) {
    a.push_back(i == 270 ? std::nan("") : std::exp(2 * stream.normal()) - 0.1);
    b.push_back(3 * stream.normal());
  }
  auto const leaf = [&](NodeId id) -> std::span<double const> { return id == x ? a : b; };
  Eigen::MatrixXd const all = evaluate_columns(graph, roots, leaf, 275);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::vector<double> const row = graph.evaluate(roots, [&](NodeId id) { return id == x ? a[i] : b[i]; });
    for (std::size_t r = 0; r < row.size(); ++r) {
      double const found = all(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(r));
      CHECK((std::bit_cast<std::uint64_t>(found) == std::bit_cast<std::uint64_t>(row[r]) || (found != found && row[r] != row[r])));
    }
  }
}

TEST_CASE("a sequence that changes its sign at each row has correlations of -1 and 1") {
  Eigen::VectorXd const errors{{1, -1, 1, -1, 1, -1, 1, -1}};
  Portmanteau const found = portmanteau(errors, 2);
  CHECK(found.correlations == doctest::Approx(-7.0 / 8 + 6.0 / 8));
  CHECK(found.statistic == doctest::Approx(80 * (49.0 / 64 / 7 + 36.0 / 64 / 6)));
}
