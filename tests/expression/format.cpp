// Infix text: parentheses where the language needs them and nowhere else.
#include <doctest/doctest.h>

#include "expression/function.hpp"
#include "expression/graph.hpp"

using namespace sysid;

TEST_CASE("an expression prints in the language's notation") {
  Graph g;
  NodeId const x = g.leaf(LeafKind::state, 0), y = g.leaf(LeafKind::state, 1);
  auto const text = [&](NodeId id) { return g.format(id, [&](NodeId leaf) { return leaf == x ? "x" : "y'"; }); };
  NodeId const sum = g.add(x, y);
  CHECK(text(sum) == "x + y'");
  CHECK(text(g.add(x, g.constant(2.5))) == "x + 2.5");
  CHECK(text(g.multiply(sum, x)) == "x*(x + y')");
  CHECK(text(g.multiply(x, g.constant(2))) == "2*x");
  CHECK(text(g.subtract(x, g.subtract(x, y))) == "x - (x - y')");
  CHECK(text(g.subtract(g.subtract(x, y), y)) == "x - y' - y'");
  CHECK(text(g.divide(x, g.multiply(x, y))) == "x/(x*y')");
  CHECK(text(g.power(g.negate(x), g.constant(-2))) == "(-x)^(-2)");
  CHECK(text(g.negate(g.power(x, y))) == "-x^y'");
  CHECK(text(g.negate(sum)) == "-(x + y')");
  CHECK(text(g.power(g.power(x, y), y)) == "(x^y')^y'");
  CHECK(text(g.power(x, g.power(y, y))) == "x^y'^y'");
  CHECK(text(g.unary(Operation::absolute, sum)) == "abs(x + y')");
  CHECK(text(g.binary(Operation::minimum, x, y)) == "min(x, y')");
  CHECK(text(g.select(g.binary(Operation::less, x, y), x, g.constant(0))) == "if x < y' then x else 0");
  CHECK(text(g.add(g.select(g.binary(Operation::less, x, y), x, y), x)) == "x + (if x < y' then x else y')");
  CHECK(text(g.unary(Operation::negation, g.binary(Operation::equal, x, y))) == "not x == y'");
  CHECK(text(g.fused(x, y, x)) == "fma(x, y', x)");
  CHECK(text(g.call(log_function, x)) == "log(x)");
}

TEST_CASE("text that would double at every level is cut, not grown") {
  Graph g;
  NodeId node = g.leaf(LeafKind::state);
  for (int i = 0; i < 200; ++i) node = g.divide(g.unary(Operation::absolute, node), g.unary(Operation::sign, node));
  CHECK(g.format(node, [](NodeId) { return "x"; }).size() < 50'000);
}
