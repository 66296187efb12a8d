// Derivatives against central differences and closed forms; substitution.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "core/text/diagnostic.hpp"
#include "expression/function.hpp"
#include "expression/graph.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

/// Central difference of order 2: error h^2 |f'''| / 6 + eps |f| / h; with h = 1e-5 and values of order 10 both are below 1e-8.
double difference(Graph const& g, NodeId root, NodeId leaf, double at, std::function<double(NodeId)> const& others) {
  double const h = 1e-5;
  auto const value = [&](double x) { return g.evaluate(root, [&](NodeId id) { return id == leaf ? x : others(id); }); };
  return (value(at + h) - value(at - h)) / (2 * h);
}

}  // namespace

TEST_CASE("every operation's derivative matches a central difference") {
  Graph g;
  NodeId const x = g.leaf(LeafKind::state, 0), y = g.leaf(LeafKind::state, 1);
  NodeId const two = g.constant(2);
  std::vector<NodeId> const roots = {
      g.negate(x),
      g.add(x, y),
      g.subtract(y, x),
      g.multiply(g.multiply(x, y), x),
      g.divide(y, x),
      g.divide(x, g.add(x, y)),
      g.power(x, g.constant(3)),
      g.power(x, g.constant(-1.5)),
      g.power(y, x),
      g.power(x, y),
      g.power(x, x),
      g.fused(x, y, g.multiply(x, x)),
      g.unary(Operation::square_root, g.add(x, y)),
      g.unary(Operation::absolute, g.subtract(x, two)),
      g.multiply(g.unary(Operation::sign, g.subtract(x, two)), x),
      g.binary(Operation::minimum, g.multiply(x, x), y),
      g.binary(Operation::maximum, g.multiply(x, x), y),
      g.select(g.binary(Operation::less, x, y), g.multiply(x, x), g.multiply(x, y)),
      g.call(log_function, g.multiply(x, y)),
  };
  for (NodeId const root : roots)
    for (double const at : {0.7, 1.3, 3.1}) {
      auto const others = [](NodeId) { return 1.9; };
      double const exact = g.evaluate(g.differentiate(root, x), [&](NodeId id) { return id == x ? at : 1.9; });
      CAPTURE(g.format(root, [&](NodeId id) { return id == x ? "x" : "y"; }));
      CHECK(exact == relative(difference(g, root, x, at, others), 1e-7));
    }
}

TEST_CASE("the derivative of a power with a constant exponent holds for a negative base") {
  Graph g;
  NodeId const x = g.leaf(LeafKind::state);
  NodeId const derivative = g.differentiate(g.power(x, g.constant(3)), x);
  CHECK(g.evaluate(derivative, [](NodeId) { return -2.0; }) == 12.0);  // 3 x^2
  CHECK(g.differentiate(g.power(x, g.constant(2)), x) == g.multiply(g.constant(2), x));
}

TEST_CASE("the derivative of abs(z)^n by n is zero at z = 0") {
  Graph g;
  NodeId const z = g.leaf(LeafKind::state), n = g.leaf(LeafKind::parameter);
  NodeId const derivative = g.differentiate(g.power(g.unary(Operation::absolute, z), n), n);
  CHECK(g.evaluate(derivative, [&](NodeId id) { return id == z ? 0.0 : 1.5; }) == 0.0);
}

TEST_CASE("what does not depend on the leaf has derivative zero, also where the function has no derivative") {
  static Function const rough{"rough", 1, [](double a) { return a; }, nullptr, nullptr, nullptr, nullptr};
  Graph g;
  NodeId const x = g.leaf(LeafKind::state, 0), y = g.leaf(LeafKind::state, 1);
  CHECK(g.differentiate(g.call(rough, y), x) == g.constant(0));
  CHECK(g.differentiate(g.unary(Operation::floor, x), x) == g.constant(0));
  CHECK_THROWS_AS(g.differentiate(g.call(rough, x), x), InternalError);
}

TEST_CASE("substitution replaces leaves, keeps sharing and places, and folds") {
  Graph g;
  NodeId const x = g.leaf(LeafKind::state, 0), y = g.leaf(LeafKind::state, 1);
  NodeId const shared = g.multiply(x, y);
  NodeId const root = g.add(shared, g.unary(Operation::absolute, shared));
  g.set_span(root, {5, 9});
  NodeId const three = g.constant(3);
  NodeId const half = g.substitute(root, [&](NodeId id) { return id == x ? std::optional<NodeId>(three) : std::nullopt; });
  CHECK(half == g.add(g.multiply(three, y), g.unary(Operation::absolute, g.multiply(three, y))));
  CHECK(g.span(half) == Span{5, 9});
  CHECK(g.constant_value(g.substitute(root, [&](NodeId) { return std::optional<NodeId>(three); })) == 18.0);
  CHECK(g.substitute(root, [](NodeId) { return std::nullopt; }) == root);
}

TEST_CASE("leaves change places in one substitution") {
  Graph g;
  NodeId const x = g.leaf(LeafKind::state, 0), y = g.leaf(LeafKind::state, 1);
  NodeId const swapped = g.substitute(g.divide(x, y), [&](NodeId id) { return std::optional<NodeId>(id == x ? y : x); });
  CHECK(swapped == g.divide(y, x));
}
