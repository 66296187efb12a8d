// Derivatives backwards through a graph against those of one root by one leaf.
#include "expression/pull_back.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "expression/finite_slope.hpp"
#include "program/random_expressions.hpp"

using namespace sysid;

TEST_CASE("a pull-back is the weighted sum of the derivatives of its roots") {
  int compared = 0;
  for (std::uint64_t index = 0; index < 200; ++index) {
    CAPTURE(index);
    Stream stream({.seed = 4, .purpose = Purpose::test, .index = index, .step = 0});
    Graph graph;
    std::vector<NodeId> leaves, weights;
    for (int i = 0; i < 4; ++i) leaves.push_back(graph.leaf(LeafKind::state, i));
    for (int i = 0; i < 3; ++i) weights.push_back(graph.leaf(LeafKind::unknown, i));
    std::vector<NodeId> const roots = testing::random_expressions(graph, leaves, 5 + static_cast<int>(stream.below(30)), 3, stream);
    std::vector<NodeId> const found = pull_back(graph, roots, weights, leaves);
    std::vector<double> values;
    for (int i = 0; i < 7; ++i) values.push_back(0.3 + 1.5 * stream.uniform());
    auto const value_of = [&](NodeId leaf) {
      Node const& node = graph[leaf];
      return values[static_cast<std::size_t>(node.index + (node.leaf_kind == LeafKind::unknown ? 4 : 0))];
    };
    for (std::size_t l = 0; l < leaves.size(); ++l) {
      double sum = 0, size = 0;
      for (std::size_t r = 0; r < roots.size(); ++r) {
        double const term = graph.evaluate(finite_slope(graph, roots[r], leaves[l]), value_of) * values[4 + r];
        sum += term;
        size += std::fabs(term);
      }
      double const value = graph.evaluate(found[l], value_of);
      if (!std::isfinite(sum) || !std::isfinite(value)) continue;
      ++compared;
      CHECK(std::fabs(value - sum) <= 1e-11 * std::max(size, 1e-3));
    }
  }
  CHECK(compared > 700);
}

TEST_CASE("a leaf that no root reads has the derivative 0, and one that is a root its weight") {
  Graph graph;
  NodeId const x = graph.leaf(LeafKind::state, 0), y = graph.leaf(LeafKind::state, 1), w = graph.leaf(LeafKind::unknown, 0);
  std::vector<NodeId> const found = pull_back(graph, std::vector{x}, std::vector{w}, std::vector{x, y});
  CHECK(found == std::vector<NodeId>{w, graph.constant(0)});
}
