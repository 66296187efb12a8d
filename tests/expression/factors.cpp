// Which products are the same up to a constant factor.
#include "expression/factors.hpp"

#include <doctest/doctest.h>

using namespace sysid;

namespace {

struct FactorLeaves {
  Graph graph;
  NodeId x = graph.leaf(LeafKind::state, 0), y = graph.leaf(LeafKind::state, 1);
  NodeId number(double value) { return graph.constant(value); }
  NodeId magnitude(NodeId a) { return graph.unary(Operation::absolute, a); }
  NodeId to(NodeId base, double exponent) { return graph.power(base, number(exponent)); }
  bool same(NodeId a, NodeId b) { return factors_of(graph, a).proportional(factors_of(graph, b)); }
};

}  // namespace

TEST_CASE("the order of factors, signs and constants do not count") {
  FactorLeaves l;
  NodeId const xy = l.graph.multiply(l.x, l.y);
  CHECK(l.same(xy, l.graph.multiply(l.graph.multiply(l.number(-3), l.y), l.x)));
  CHECK(l.same(xy, l.graph.negate(xy)));
  CHECK(l.same(l.x, l.graph.divide(l.graph.multiply(l.x, l.y), l.y)));
  CHECK_FALSE(l.same(xy, l.x));
  CHECK(factors_of(l.graph, l.graph.divide(l.graph.multiply(l.number(-6), l.x), l.graph.multiply(l.number(2), l.y))).constant ==
        -3);
}

TEST_CASE("powers are multiplied out where that holds for every sign") {
  FactorLeaves l;
  CHECK(l.same(l.to(l.x, 3), l.graph.multiply(l.x, l.graph.multiply(l.x, l.x))));
  CHECK(l.same(l.to(l.graph.multiply(l.x, l.y), 2), l.graph.multiply(l.to(l.x, 2), l.to(l.y, 2))));
  // (x^2)^(1/2) is |x|.
  CHECK_FALSE(l.same(l.to(l.to(l.x, 2), 0.5), l.x));
}

TEST_CASE("magnitudes are those of factors, and their even powers lose them") {
  FactorLeaves l;
  CHECK(l.same(l.magnitude(l.graph.multiply(l.number(-2), l.x)), l.magnitude(l.x)));
  CHECK(l.same(l.graph.multiply(l.magnitude(l.x), l.magnitude(l.y)), l.magnitude(l.graph.multiply(l.x, l.y))));
  CHECK(l.same(l.graph.multiply(l.magnitude(l.x), l.magnitude(l.x)), l.to(l.x, 2)));
  CHECK(l.same(l.to(l.magnitude(l.x), 2), l.to(l.x, 2)));
  CHECK_FALSE(l.same(l.graph.multiply(l.magnitude(l.x), l.x), l.to(l.x, 2)));
}
