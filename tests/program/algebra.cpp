// Rewriting keeps values and saves work: Horner, powers as products, shared powers, factors gathered by binding time.
#include "program/algebra.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "core/numeric/elementary.hpp"
#include "core/numeric/random.hpp"
#include "program/random_expressions.hpp"

using namespace sysid;

namespace {

/// Number of nodes of an operation below the root.
int count(Graph const& graph, NodeId root, Operation operation) {
  int result = 0;
  for (NodeId const id : graph.reachable({&root, 1})) result += graph[id].operation == operation;
  return result;
}

/// Operations computed at the step: what an executor would run.
int work(Graph const& graph, NodeId root) {
  BindingTimes binding(graph);
  int result = 0;
  for (NodeId const id : graph.reachable({&root, 1}))
    result += binding.is_step(id) && graph.operand_count(id) > 0 && graph[id].operation != Operation::negate;
  return result;
}

struct Bench {
  Graph g;
  NodeId p(int i) { return g.leaf(LeafKind::parameter, i); }
  NodeId y(int i = 0) { return g.leaf(LeafKind::state, i); }
  NodeId x() { return g.leaf(LeafKind::input, 0); }

  NodeId rewrite(NodeId root) { return Algebra(g, {&root, 1}).rewrite(root); }

  double value(NodeId root, double scale = 1) const {
    return g.evaluate(root,
                      [&](NodeId id) { return scale * (0.7 + 0.31 * g[id].index + 0.17 * static_cast<int>(g[id].leaf_kind)); });
  }

  /// The rewritten root; checks that both have the same value to `ulps` of it.
  NodeId checked(NodeId root, double ulps = 8) {
    NodeId const after = rewrite(root);
    for (double const scale : {1.0, 0.3, 2.7}) {
      double const expected = value(root, scale);
      CHECK(std::abs(value(after, scale) - expected) <= ulps * std::numeric_limits<double>::epsilon() * std::abs(expected));
    }
    return after;
  }
};

}  // namespace

TEST_CASE("a cubic spring is Horner's form: y (k + k3 y^2) takes three operations") {
  Bench b;
  NodeId const force = b.g.add(b.g.multiply(b.p(0), b.y()), b.g.multiply(b.p(1), b.g.power(b.y(), b.g.constant(3))));
  CHECK(work(b.g, b.checked(force)) == 3);
}

TEST_CASE("a full polynomial of degree five takes one fused operation per degree") {
  Bench b;
  NodeId polynomial = b.p(0);
  for (int n = 1; n <= 5; ++n) polynomial = b.g.add(polynomial, b.g.multiply(b.p(n), b.g.power(b.y(), b.g.constant(n))));
  CHECK(work(b.g, b.checked(polynomial)) == 5);
}

TEST_CASE("equal terms merge into one with a coefficient known per parameter vector") {
  Bench b;
  NodeId const damping = b.g.add(b.g.multiply(b.p(0), b.y()), b.g.multiply(b.p(1), b.y()));
  CHECK(work(b.g, b.checked(damping)) == 1);
}

TEST_CASE("a division by parameters is a product with a reciprocal computed once") {
  Bench b;
  NodeId const acceleration = b.g.divide(b.g.subtract(b.x(), b.g.multiply(b.p(0), b.y())), b.p(1));
  NodeId const after = b.checked(acceleration);
  CHECK(work(b.g, after) == 2);
  BindingTimes binding(b.g);
  for (NodeId const id : b.g.reachable({&after, 1})) CHECK_FALSE((b.g[id].operation == Operation::divide && binding.is_step(id)));
}

TEST_CASE("factors and addends known early are gathered even when written apart") {
  Bench b;
  NodeId const product = b.g.multiply(b.g.multiply(b.p(0), b.y()), b.p(1));
  CHECK(work(b.g, b.checked(product)) == 1);
  NodeId const sum = b.g.add(b.g.add(b.p(0), b.y()), b.g.subtract(b.p(1), b.g.constant(2)));
  CHECK(work(b.g, b.checked(sum)) == 1);
}

TEST_CASE("even powers drop the absolute value and integer powers call no function") {
  Bench b;
  NodeId const magnitude = b.g.unary(Operation::absolute, b.y());
  NodeId const even = b.checked(b.g.power(magnitude, b.g.constant(4)));
  CHECK(count(b.g, even, Operation::absolute) == 0);
  CHECK(work(b.g, even) == 2);
  NodeId const odd = b.checked(b.g.multiply(magnitude, b.g.power(magnitude, b.g.constant(2))));
  CHECK(count(b.g, odd, Operation::absolute) == 1);
  CHECK(count(b.g, odd, Operation::power) == 0);
}

TEST_CASE("half-integer powers are square roots times products") {
  Bench b;
  for (double const exponent : {0.5, 1.5, -0.5, -1.5, 2.5}) {
    NodeId const after = b.checked(b.g.power(b.y(), b.g.constant(exponent)));
    CHECK(count(b.g, after, Operation::power) == 0);
    CHECK(count(b.g, after, Operation::square_root) == 1);
  }
}

TEST_CASE("powers whose exponents differ by one share one power, with the right value at zero") {
  Bench b;
  NodeId const n = b.p(0), z = b.g.unary(Operation::absolute, b.y());
  NodeId const low = b.g.power(z, b.g.subtract(n, b.g.constant(1))), high = b.g.power(z, n);
  std::vector<NodeId> const roots{low, high};
  Algebra algebra(b.g, roots);
  NodeId const both[] = {algebra.rewrite(low), algebra.rewrite(high)};
  int step_powers = 0;
  for (NodeId const id : b.g.reachable(both)) step_powers += b.g[id].operation == Operation::power && algebra.binding().is_step(id);
  CHECK(step_powers == 1);
  for (double const exponent : {0.4, 1.0, 1.5, 2.0, 0.0}) {
    for (double const state : {0.0, -0.3, 2.0}) {
      auto const value_of = [&](NodeId id) { return b.g[id].leaf_kind == LeafKind::parameter ? exponent : state; };
      double const expected = elementary::pow(std::abs(state), exponent);
      CHECK(std::abs(b.g.evaluate(both[1], value_of) - expected) <= 4 * std::numeric_limits<double>::epsilon() * expected);
      CHECK(b.g.evaluate(both[0], value_of) == elementary::pow(std::abs(state), exponent - 1));
    }
  }
}

TEST_CASE("a quotient of states is not cancelled: 0/0 stays undefined") {
  Bench b;
  NodeId const quotient = b.rewrite(b.g.divide(b.g.power(b.y(), b.g.constant(3)), b.g.power(b.y(), b.g.constant(2))));
  CHECK(std::isnan(b.g.evaluate(quotient, [](NodeId) { return 0.0; })));
}

TEST_CASE("random expressions keep their values") {
  // Rewriting changes the rounding of sums that cancel; the comparison is with the sum of magnitudes, bounded by evaluating the
  // same expression in two orders: a relative 1e-9 of the largest intermediate value.
  int compared = 0;
  for (std::uint64_t index = 0; index < 300; ++index) {
    Stream stream({.seed = 21, .purpose = Purpose::test, .index = index, .step = 0});
    Graph g;
    std::vector<NodeId> const leaves{g.leaf(LeafKind::parameter, 0), g.leaf(LeafKind::parameter, 1), g.leaf(LeafKind::state, 0),
                                     g.leaf(LeafKind::state, 1),     g.leaf(LeafKind::input, 0),     g.leaf(LeafKind::time)};
    std::vector<NodeId> const roots = testing::random_expressions(g, leaves, 30, 3, stream);
    std::vector<NodeId> const below = g.reachable(roots);
    Algebra algebra(g, roots);
    std::vector<NodeId> after;
    for (NodeId const root : roots) after.push_back(algebra.rewrite(root));
    for (int trial = 0; trial < 5; ++trial) {
      std::vector<double> values;
      for (int i = 0; i < 6; ++i) values.push_back(0.3 + 2 * stream.uniform());
      auto const value_of = [&](NodeId id) {
        for (std::size_t i = 0; i < leaves.size(); ++i)
          if (leaves[i] == id) return values[i];
        return 0.0;
      };
      double largest = 0, smallest_step = 1;
      bool jumps = false;
      for (std::size_t i = 0; i < below.size(); ++i) {
        double const value = g.evaluate(below[i], value_of);
        largest = std::max(largest, std::abs(value));
        // Near a jump or a pole the last bit decides.
        Node const& node = g[below[i]];
        if (node.operation == Operation::sign || node.operation == Operation::floor || node.operation == Operation::less ||
            node.operation == Operation::less_equal || node.operation == Operation::equal ||
            node.operation == Operation::negation || node.operation == Operation::disjunction ||
            node.operation == Operation::conjunction)
          jumps = true;
        if (node.operation == Operation::divide) smallest_step = std::min(smallest_step, std::abs(g.evaluate(node.b, value_of)));
        if (node.operation == Operation::call) smallest_step = std::min(smallest_step, std::abs(g.evaluate(node.a, value_of)));
      }
      if (jumps || !(largest < 1e6) || smallest_step < 1e-3) continue;
      for (std::size_t i = 0; i < roots.size(); ++i) {
        ++compared;
        CHECK(std::abs(g.evaluate(after[i], value_of) - g.evaluate(roots[i], value_of)) <= 1e-9 * (1 + largest));
      }
    }
  }
  CHECK(compared > 200);
}
