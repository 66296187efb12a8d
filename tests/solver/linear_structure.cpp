// What is linear in the states, what is not and where, and which inputs must be held.
#include "solver/linear_structure.hpp"

#include <doctest/doctest.h>

using namespace sysid;

namespace {

struct Leaves {
  Graph g;
  NodeId y = g.leaf(LeafKind::state, 0), v = g.leaf(LeafKind::state, 1), u = g.leaf(LeafKind::input, 0),
         w = g.leaf(LeafKind::input, 1), rate = g.leaf(LeafKind::input_rate, 0), t = g.leaf(LeafKind::time),
         k = g.leaf(LeafKind::parameter, 0), m = g.leaf(LeafKind::parameter, 1);

  std::optional<NotLinear> of(NodeId root) { return find_nonlinear(g, {&root, 1}); }
};

}  // namespace

TEST_CASE("sums, and products with parameters, are linear") {
  Leaves l;
  Graph& g = l.g;
  NodeId const spring = g.multiply(g.power(l.k, g.constant(3)), g.subtract(l.u, l.y));
  CHECK_FALSE(l.of(g.divide(g.add(spring, g.negate(l.v)), g.add(l.m, g.constant(1)))));
  CHECK_FALSE(l.of(g.select(g.binary(Operation::less, l.k, l.m), l.y, g.multiply(g.constant(2), l.v))));
  CHECK_FALSE(l.of(g.multiply(l.u, g.unary(Operation::absolute, l.w))));
  CHECK_FALSE(l.of(g.constant(0)));
}

TEST_CASE(
    "the intensity of a disturbance stays the same along a step: time does not scale it, and an input only where it is held") {
  Leaves l;
  Graph& g = l.g;
  NodeId const noise = g.leaf(LeafKind::disturbance, 0);
  CHECK_FALSE(l.of(g.add(l.t, g.multiply(l.k, noise))));
  auto const found = l.of(g.add(l.y, g.multiply(l.t, noise)));
  REQUIRE(found);
  CHECK(found->why == NotLinear::Why::time);
  NodeId const scaled = g.multiply(l.u, noise), beside = g.add(l.w, noise);
  CHECK(inputs_not_linear(g, {&scaled, 1}) == std::vector<int>{0});
  CHECK(inputs_not_linear(g, {&beside, 1}).empty());
}

TEST_CASE("the part that is not linear is found, however small it is") {
  Leaves l;
  Graph& g = l.g;
  NodeId const zero_slope = g.unary(Operation::sign, l.v), cube = g.power(l.y, g.constant(3)), product = g.multiply(l.y, l.v);
  for (NodeId const part : {zero_slope, cube, product, g.divide(l.k, l.y), g.unary(Operation::absolute, l.y),
                            g.select(g.binary(Operation::less, l.y, l.k), l.y, l.v)}) {
    auto const found = l.of(g.add(l.y, g.multiply(l.k, part)));
    REQUIRE(found);
    CHECK(found->why == NotLinear::Why::nonlinear);
    bool const below = found->node == part || g[part].a == found->node;  // the condition of a choice comes first
    CHECK(below);
  }
}

TEST_CASE("coefficients that change in time, and time itself, are told apart") {
  Leaves l;
  Graph& g = l.g;
  for (NodeId const other : {l.u, l.t, l.rate}) {
    NodeId const part = g.multiply(other, l.y);
    auto const found = l.of(g.add(part, l.v));
    REQUIRE(found);
    CHECK(found->why == NotLinear::Why::varies);
    CHECK(found->node == part);
    CHECK(l.of(g.divide(l.y, g.add(other, l.k)))->why == NotLinear::Why::varies);
    CHECK(l.of(g.divide(other, l.y))->why == NotLinear::Why::nonlinear);
  }
  CHECK_FALSE(l.of(g.add(g.multiply(l.k, l.t), g.subtract(l.y, g.unary(Operation::absolute, l.u)))));
  for (NodeId const part : {g.multiply(l.t, l.t), g.multiply(l.t, l.u), g.unary(Operation::square_root, l.t),
                            g.multiply(g.multiply(l.u, l.u), l.t), g.divide(l.k, l.t)})
    CHECK(l.of(g.add(part, l.y))->why == NotLinear::Why::time);
  CHECK(l.of(g.leaf(LeafKind::process, 0))->why == NotLinear::Why::nonlinear);
}

TEST_CASE("inputs that are read other than linearly") {
  Leaves l;
  Graph& g = l.g;
  auto const held = [&](NodeId root) { return inputs_not_linear(g, {&root, 1}); };
  CHECK(held(g.subtract(g.multiply(l.k, l.u), g.add(l.y, l.rate))).empty());
  CHECK(held(g.add(g.multiply(l.w, l.w), l.u)) == std::vector{1});
  CHECK(held(g.multiply(l.w, l.u)) == std::vector{0, 1});
  CHECK(held(g.unary(Operation::absolute, l.rate)) == std::vector{0});
}
