// Building and looking: one node per expression, folding, neutral elements, evaluation.
#include "expression/graph.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

using namespace sysid;

namespace {

struct Leaves {
  Graph graph;
  NodeId x = graph.leaf(LeafKind::state, 0), y = graph.leaf(LeafKind::state, 1), z = graph.leaf(LeafKind::parameter, 0);
  NodeId number(double value) { return graph.constant(value); }
};

}  // namespace

TEST_CASE("equal expressions are one node") {
  Leaves l;
  Graph& g = l.graph;
  CHECK(g.leaf(LeafKind::state, 0) == l.x);
  CHECK(g.leaf(LeafKind::state, 0, Stage::middle) != l.x);
  CHECK(g.leaf(LeafKind::input, 0) != l.x);
  CHECK(g.add(l.x, l.y) == g.add(l.x, l.y));
  CHECK(g.subtract(l.x, l.y) != g.subtract(l.y, l.x));
  NodeId const before = g.multiply(l.z, g.add(l.x, l.y));
  std::size_t const size = g.size();
  CHECK(g.multiply(g.add(l.y, l.x), l.z) == before);
  CHECK(g.size() == size);
}

TEST_CASE("operands of commutative operations are put in one order, others keep theirs") {
  Leaves l;
  Graph& g = l.graph;
  for (Operation const operation :
       {Operation::add, Operation::multiply, Operation::equal, Operation::conjunction, Operation::disjunction})
    CHECK(g.binary(operation, l.x, l.y) == g.binary(operation, l.y, l.x));
  for (Operation const operation : {Operation::subtract, Operation::divide, Operation::power, Operation::less,
                                    Operation::less_equal, Operation::minimum, Operation::maximum})
    CHECK(g.binary(operation, l.x, l.y) != g.binary(operation, l.y, l.x));
  CHECK(g.fused(l.x, l.y, l.z) == g.fused(l.y, l.x, l.z));
}

TEST_CASE("constants fold by apply") {
  Leaves l;
  Graph& g = l.graph;
  CHECK(g.constant_value(g.add(l.number(0.1), l.number(0.2))) == 0.1 + 0.2);
  CHECK(g.constant_value(g.unary(Operation::square_root, l.number(2))) == std::sqrt(2.0));
  CHECK(g.constant_value(g.power(l.number(2), l.number(10))) == 1024.0);
  CHECK(g.constant_value(g.fused(l.number(3), l.number(4), l.number(5))) == 17.0);
  CHECK(g.constant_value(g.binary(Operation::less, l.number(1), l.number(2))) == 1.0);
  CHECK(g.constant_value(g.binary(Operation::minimum, l.number(1), l.number(2))) == 1.0);
  CHECK(g.constant_value(g.unary(Operation::sign, l.number(-3))) == -1.0);
  CHECK(g.constant_value(g.unary(Operation::sign, l.number(0))) == 0.0);
  // 0*inf of two constants is what arithmetic says, not the rule for x*0.
  CHECK(std::isnan(*g.constant_value(g.multiply(l.number(0), l.number(std::numeric_limits<double>::infinity())))));
}

TEST_CASE("neutral elements vanish") {
  Leaves l;
  Graph& g = l.graph;
  NodeId const zero = l.number(0), one = l.number(1);
  CHECK(g.add(l.x, zero) == l.x);
  CHECK(g.add(zero, l.x) == l.x);
  CHECK(g.subtract(l.x, zero) == l.x);
  CHECK(g.subtract(zero, l.x) == g.negate(l.x));
  CHECK(g.subtract(l.x, l.x) == zero);
  CHECK(g.multiply(l.x, one) == l.x);
  CHECK(g.multiply(zero, l.x) == zero);
  CHECK(g.multiply(l.number(-1), l.x) == g.negate(l.x));
  CHECK(g.divide(l.x, one) == l.x);
  CHECK(g.divide(zero, l.x) == zero);
  CHECK(g.power(l.x, one) == l.x);
  CHECK(g.power(l.x, zero) == one);
  CHECK(g.negate(g.negate(l.x)) == l.x);
  CHECK(g.add(l.x, g.negate(l.y)) == g.subtract(l.x, l.y));
  CHECK(g.select(one, l.x, l.y) == l.x);
  CHECK(g.select(zero, l.x, l.y) == l.y);
  CHECK(g.select(g.binary(Operation::less, l.x, l.y), l.z, l.z) == l.z);
}

TEST_CASE("division by a constant stays a division, because the reciprocal would round differently") {
  Leaves l;
  Graph& g = l.graph;
  CHECK(g[g.divide(l.x, l.number(3))].operation == Operation::divide);
}

TEST_CASE("constants are told apart by their bits and there is one NaN") {
  Leaves l;
  CHECK(l.number(0.0) != l.number(-0.0));
  CHECK(l.number(std::nan("1")) == l.number(-std::nan("2")));
}

TEST_CASE("a sum with a NaN stays NaN") {
  Leaves l;
  Graph& g = l.graph;
  NodeId const nan = l.number(std::numeric_limits<double>::quiet_NaN());
  CHECK(std::isnan(*g.constant_value(g.add(nan, l.number(1)))));
  CHECK(std::isnan(g.evaluate(g.add(nan, l.x), [](NodeId) { return 1.0; })));
}

TEST_CASE("what compares a NaN is NaN, folded or evaluated, whichever operand it is") {
  for (bool const folded : {true, false}) {
    CAPTURE(folded);
    Graph g;
    auto const value = [&](Operation operation, double a, double b) {
      if (folded) return *g.constant_value(g.binary(operation, g.constant(a), g.constant(b)));
      NodeId const node = g.binary(operation, g.leaf(LeafKind::unknown, 0), g.leaf(LeafKind::unknown, 1));
      return g.evaluate(node, [&](NodeId leaf) { return g[leaf].index == 0 ? a : b; });
    };
    double const nan = std::nan("");
    for (Operation const operation :
         {Operation::minimum, Operation::maximum, Operation::less, Operation::less_equal, Operation::equal})
      for (double const other : {-1.0, 0.0, 1.0, HUGE_VAL, nan}) {
        CHECK(std::isnan(value(operation, nan, other)));
        CHECK(std::isnan(value(operation, other, nan)));
      }
    // A guard guards: what is decided by one operand does not need the other.
    CHECK(value(Operation::conjunction, 0, nan) == 0);
    CHECK(value(Operation::conjunction, nan, 0) == 0);
    CHECK(std::isnan(value(Operation::conjunction, 1, nan)));
    CHECK(std::isnan(value(Operation::conjunction, nan, 1)));
    CHECK(value(Operation::disjunction, 1, nan) == 1);
    CHECK(value(Operation::disjunction, nan, 1) == 1);
    CHECK(std::isnan(value(Operation::disjunction, 0, nan)));
    CHECK(std::isnan(value(Operation::disjunction, nan, 0)));
  }
  Graph g;
  NodeId const nan = g.constant(std::nan("")), x = g.leaf(LeafKind::state, 0), y = g.leaf(LeafKind::state, 1);
  for (Operation const operation : {Operation::sign, Operation::negation, Operation::floor, Operation::absolute})
    CHECK(std::isnan(*g.constant_value(g.unary(operation, nan))));
  CHECK(g.select(nan, x, y) == nan);
  NodeId const chosen = g.select(x, g.constant(1), g.constant(2));
  CHECK(std::isnan(g.evaluate(chosen, [](NodeId) { return std::nan(""); })));
}

TEST_CASE("a leaf is rebuilt as it was") {
  Graph g;
  NodeId const leaf = g.leaf(LeafKind::input, 2, Stage::middle, 3);
  CHECK(g.rebuild(Node(g[leaf]), 0, 0, 0) == leaf);
}

TEST_CASE("evaluate agrees with the expression written in C++") {
  Leaves l;
  Graph& g = l.graph;
  NodeId const value = g.divide(g.subtract(g.multiply(l.x, l.x), l.y), g.add(l.z, l.number(2)));
  auto const leaf = [&](NodeId id) { return id == l.x ? 1.7 : id == l.y ? 0.3 : 11.0; };
  CHECK(g.evaluate(value, leaf) == (1.7 * 1.7 - 0.3) / (11.0 + 2.0));
  NodeId const roots[] = {l.y, value};
  std::vector<double> const both = g.evaluate(roots, leaf);
  CHECK(both[0] == 0.3);
  CHECK(both[1] == g.evaluate(value, leaf));
}

TEST_CASE("a condition is one or zero and selects a branch") {
  Leaves l;
  Graph& g = l.graph;
  NodeId const inside = g.binary(Operation::conjunction, g.binary(Operation::less_equal, l.number(0), l.x),
                                 g.binary(Operation::less, l.x, l.number(1)));
  NodeId const value = g.select(inside, l.y, l.z);
  for (double const x : {-1.0, 0.0, 0.5, 1.0})
    CHECK(g.evaluate(value, [&](NodeId id) { return id == l.x ? x : id == l.y ? 10.0 : 20.0; }) == (x >= 0 && x < 1 ? 10.0 : 20.0));
}

TEST_CASE("reachable lists each node once, operands before users") {
  Leaves l;
  Graph& g = l.graph;
  NodeId const shared = g.add(l.x, l.y);
  NodeId const root = g.multiply(shared, g.unary(Operation::absolute, shared));
  g.add(root, l.z);  // a user of root is not below it
  std::vector<NodeId> const order = g.reachable({&root, 1});
  REQUIRE(order.size() == 5);
  for (std::size_t i = 1; i < order.size(); ++i) CHECK(order[i - 1] < order[i]);
  CHECK(order.back() == root);
  CHECK(g.reachable({}).empty());
}

TEST_CASE("depends sees the leaves below a node") {
  Leaves l;
  Graph& g = l.graph;
  NodeId const root = g.multiply(l.x, l.y);
  CHECK(g.depends(root, [](Node const& leaf) { return leaf.leaf_kind == LeafKind::state && leaf.index == 1; }));
  CHECK_FALSE(g.depends(root, [](Node const& leaf) { return leaf.leaf_kind == LeafKind::parameter; }));
}

TEST_CASE("the first span given to a node stays") {
  Leaves l;
  Graph& g = l.graph;
  CHECK_FALSE(g.span(l.x).has_value());
  g.set_span(l.x, {3, 4});
  g.set_span(l.x, {7, 8});
  CHECK(g.span(l.x) == Span{3, 4});
}

TEST_CASE("a graph a million deep is evaluated, differentiated and substituted without recursion") {
  Leaves l;
  Graph& g = l.graph;
  NodeId node = l.x;
  for (int i = 0; i < 1'000'000; ++i) node = i % 2 == 0 ? g.add(node, l.y) : g.multiply(node, l.z);
  // z = 1: the value is x + 500000 y, exactly.
  CHECK(g.evaluate(node, [&](NodeId id) { return id == l.x ? 3.0 : 1.0; }) == 500'003.0);
  CHECK(g.evaluate(g.differentiate(node, l.x), [](NodeId) { return 1.0; }) == 1.0);
  NodeId const shifted = g.substitute(node, [&](NodeId id) { return id == l.x ? std::optional<NodeId>(l.y) : std::nullopt; });
  CHECK(g.evaluate(shifted, [](NodeId) { return 1.0; }) == 500'001.0);
}
