// The surfaces of kinks and jumps: each operation's own, told apart by what moves them.
#include <doctest/doctest.h>

#include <vector>

#include "expression/switching.hpp"
#include "expression/term.hpp"

using namespace sysid;

namespace {

struct SwitchingLeaves {
  Graph graph;
  Term x{graph, graph.leaf(LeafKind::state, 0)}, y{graph, graph.leaf(LeafKind::state, 1)};
  Term u{graph, graph.leaf(LeafKind::input, 0)}, t{graph, graph.leaf(LeafKind::time)};
  Term p{graph, graph.leaf(LeafKind::parameter, 0)};

  std::vector<SwitchingSurface> of(Term root) { return switching_surfaces(graph, {&root.id, 1}); }
};

}  // namespace

TEST_CASE("each operation that switches gives what it compares") {
  SwitchingLeaves s;
  CHECK(s.of(abs(s.x * s.p)).front().value == (s.x * s.p).id);
  CHECK(s.of(sign(s.x)).front().value == s.x.id);
  CHECK(s.of(min(s.x, s.y)).front().value == (s.x - s.y).id);
  CHECK(s.of(max(s.x, Term(s.graph, 2.0))).front().value == (s.x - 2.0).id);
  CHECK(s.of(select(less(s.x, s.y), s.x, s.y)).front().value == (s.x - s.y).id);
  CHECK(s.of(select(less_equal(s.x, s.y), s.x, s.y)).size() == 1);
  CHECK(s.of(select(s.x, s.y, s.p)).front().value == s.x.id);
  auto const steps = s.of(floor(s.x));
  REQUIRE(steps.size() == 1);
  CHECK(steps.front().value == s.x.id);
  CHECK(steps.front().at_integers);
}

TEST_CASE("what bends is told from what may jump, also where both switch at one place") {
  SwitchingLeaves s;
  CHECK_FALSE(s.of(abs(s.x)).front().jumps);
  CHECK_FALSE(s.of(max(s.x, s.y)).front().jumps);
  CHECK(s.of(sign(s.x)).front().jumps);
  CHECK(s.of(floor(s.x)).front().jumps);
  CHECK(s.of(select(less(s.x, s.y), s.x, s.y)).front().jumps);
  auto const both = s.of(abs(s.x) + sign(s.x));
  REQUIRE(both.size() == 1);
  CHECK(both.front().jumps);
}

TEST_CASE("surfaces of time and inputs alone are told from those of states") {
  SwitchingLeaves s;
  auto const of_input = s.of(abs(s.u)), of_time = s.of(select(less(s.t, s.p), s.x, s.y)), of_state = s.of(abs(s.x - s.u));
  REQUIRE(of_input.size() == 1);
  CHECK(of_input.front().reads_inputs);
  CHECK_FALSE(of_input.front().reads_states);
  REQUIRE(of_time.size() == 1);
  CHECK_FALSE(of_time.front().reads_inputs);
  CHECK_FALSE(of_time.front().reads_states);
  REQUIRE(of_state.size() == 1);
  CHECK(of_state.front().reads_states);
  CHECK(of_state.front().reads_inputs);
}

TEST_CASE("what moves with parameters alone is none, and equal surfaces are one") {
  SwitchingLeaves s;
  CHECK(s.of(abs(s.p) * s.x).empty());
  CHECK(s.of(s.x * s.y + pow(s.x, s.p)).empty());
  CHECK(s.of(abs(s.x) * pow(abs(s.x), s.p) * sign(s.x)).size() == 1);
  // Kinks inside kinks: | |x| - 1 | switches at x = 0 and at |x| = 1.
  CHECK(s.of(abs(abs(s.x) - 1.0)).size() == 2);
}
