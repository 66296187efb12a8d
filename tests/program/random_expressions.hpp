// Random expressions over given leaves, with every operation; for tests that hold executors and rewriting to plain evaluation.
#pragma once
#include <vector>

#include "core/numeric/random.hpp"
#include "expression/function.hpp"
#include "expression/graph.hpp"

namespace sysid::testing {

/// `count` nodes built on one another from the leaves and constants; returns those built last, which together use most of them.
inline std::vector<NodeId> random_expressions(Graph& graph, std::vector<NodeId> nodes, int count, int roots, Stream& stream) {
  auto const pick = [&] { return nodes[stream.below(nodes.size())]; };
  for (int i = 0; i < 3; ++i) nodes.push_back(graph.constant(0.5 + 2 * stream.uniform()));
  for (int i = 0; i < count; ++i) {
    NodeId const a = pick(), b = pick(), c = pick();
    NodeId node = 0;
    switch (stream.below(24)) {
      case 0:
        node = graph.negate(a);
        break;
      case 1:
      case 2:
      case 3:
        node = graph.add(a, b);
        break;
      case 4:
      case 5:
        node = graph.subtract(a, b);
        break;
      case 6:
      case 7:
      case 8:
        node = graph.multiply(a, b);
        break;
      case 9:
        node = graph.divide(a, b);
        break;
      case 10:
        node = graph.fused(graph.negate(a), b, c);
        break;
      case 11:
        node = graph.fused(a, b, graph.negate(c));
        break;
      case 12:
        node = graph.fused(graph.negate(a), b, graph.negate(c));
        break;
      case 13:
        node = graph.fused(a, b, c);
        break;
      case 14:
        node = graph.unary(Operation::square_root, graph.unary(Operation::absolute, a));
        break;
      case 15:
        node = graph.unary(Operation::sign, a);
        break;
      case 16:
        node = graph.binary(Operation::minimum, a, b);
        break;
      case 17:
        node = graph.binary(Operation::maximum, a, b);
        break;
      case 18:
        node = graph.unary(Operation::floor, a);
        break;
      case 19:
        node = graph.select(graph.binary(Operation::less, a, b), c, a);
        break;
      case 20:
        node = graph.select(graph.binary(Operation::disjunction, graph.binary(Operation::less_equal, a, b), c), b, c);
        break;
      case 21:
        node = graph.binary(Operation::conjunction, graph.unary(Operation::negation, graph.binary(Operation::equal, a, b)), c);
        break;
      case 22:
        node = graph.power(graph.unary(Operation::absolute, a), graph.constant(1.37));
        break;
      default:
        node = graph.call(log_function, graph.unary(Operation::absolute, a));
        break;
    }
    nodes.push_back(node);
  }
  return {nodes.end() - roots, nodes.end()};
}

}  // namespace sysid::testing
