// Modes followed to a neighbouring target.
#include "search/refit.hpp"

#include <doctest/doctest.h>

#include "inference/targets.hpp"
#include "search/search.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

/// N(x | centre, 0.1^2) under a wide prior; not solvable at all when `broken`.
TestTarget centred(double centre, bool broken = false) {
  return TestTarget({"x"}, {{Prior::normal, 0, 10}}, 1, 0, [=](std::vector<double> const& w, std::vector<double>& rows) {
    rows[0] = broken ? infinity : (w[0] - centre) / 0.1;
  });
}

}  // namespace

TEST_CASE("a mode follows its target, and its move is measured in its own sds") {
  Bench bench;
  std::vector<Mode> const modes = search(centred(2), ObjectiveKind::posterior, bench.context).modes;
  REQUIRE(modes.size() == 1);
  std::vector<double> gains;
  std::vector<Mode> const same = refit(centred(2), ObjectiveKind::posterior, modes, 1, bench.ledger),
                          moved = refit(centred(2.05), ObjectiveKind::posterior, modes, 1, bench.ledger, {}, &gains);
  TestTarget const target = centred(2);
  CHECK(largest_move(target.parameters(), modes[0], same[0], 0).size() < 1e-3);
  // The prior holds back 1e-4 of the move: half an sd.
  REQUIRE(gains.size() == 1);
  CHECK(gains[0] == doctest::Approx(0.125).epsilon(1e-3));
  sysid::Move const move = largest_move(target.parameters(), modes[0], moved[0], gains[0]);
  CHECK(move.value == doctest::Approx(0.5).epsilon(1e-3));
  CHECK(move.size() == doctest::Approx(0.5).epsilon(1e-2));
  // Where nothing is gained, the sd is wrong, and there is no move.
  CHECK(largest_move(target.parameters(), modes[0], moved[0], 0).size() == 0);
  CHECK(moved[0].share == modes[0].share);
  CHECK(refit(centred(2), ObjectiveKind::posterior, {}, 1, bench.ledger).empty());
}

TEST_CASE("a change of width is a move of the limits") {
  Mode narrow, wide;
  narrow.declared = wide.declared = {1, 5};
  narrow.sd = {0.5, 0.1};
  wide.sd = {0.5, 0.3};
  std::vector<ParameterInfo> const free(2, {"", "", -infinity, infinity});
  sysid::Move const move = largest_move(free, narrow, wide, 0);
  CHECK(move.parameter == 1);
  CHECK(move.value == 0);
  CHECK(move.size() == doctest::Approx(2).epsilon(1e-12));
  // Not along a direction that nothing resists, nor at a bound.
  Mode flat = narrow;
  flat.flat = {0, 0.1};
  CHECK(largest_move(free, flat, wide, 0).size() == 0);
  std::vector<ParameterInfo> const bounded = {{"", "", -infinity, infinity}, {"", "", 0, 5}};
  CHECK(largest_move(bounded, narrow, wide, 0).size() == 0);
}

TEST_CASE("where the finer of two modes is flat the sds of the other measure its move") {
  Mode finer, coarser;
  finer.declared = {20, 1};
  finer.sd = {950, 0.1};
  finer.flat = {90, 0};
  coarser.declared = {10, 1};
  coarser.sd = {0.5, 0.1};
  std::vector<ParameterInfo> const free(2, {"", "", -infinity, infinity});
  CHECK(largest_move(free, finer, coarser, 300).size() == doctest::Approx(20).epsilon(1e-12));
  CHECK(largest_move(free, finer, coarser, 12).size() == doctest::Approx(std::sqrt(24)).epsilon(1e-12));  // as the gain allows
  coarser.flat = finer.flat;
  CHECK(largest_move(free, finer, coarser, 0.4).size() == doctest::Approx(10.0 / 950).epsilon(1e-12));
  CHECK(largest_move(free, finer, coarser, 8).size() == doctest::Approx(4).epsilon(1e-12));  // which the flat direction hides
}

TEST_CASE("a bound is reached within a thousandth of the support, or of a positive lower bound") {
  CHECK(at_bound({"", "", 0, 1}, 0.9995, 0.1));
  CHECK_FALSE(at_bound({"", "", 0, 1}, 0.998, 0.1));
  CHECK(at_bound({"", "", 1e-3, 1}, 1.0005e-3, 0.1));
  CHECK_FALSE(at_bound({"", "", 1e-3, 1}, 1.1e-3, 0.1));
  CHECK_FALSE(at_bound({"", "", -infinity, infinity}, 1e300, 0.1));
}

TEST_CASE("one bound alone is reached within a tenth of an sd") {
  CHECK(at_bound({"", "", 3.4, infinity}, 3.4 + 1e-12, 2e-11));
  CHECK(at_bound({"", "", 3.4, infinity}, 3.4, 0));
  CHECK_FALSE(at_bound({"", "", 3.4, infinity}, 3.4 + 1e-9, 2e-9));
  CHECK(at_bound({"", "", -infinity, 0}, -1e-12, 2e-11));
}

TEST_CASE("a mode that can no longer be solved keeps its place and has moved infinitely far") {
  Bench bench;
  std::vector<Mode> const modes = search(centred(2), ObjectiveKind::posterior, bench.context).modes;
  std::vector<Mode> const lost = refit(centred(2, true), ObjectiveKind::posterior, modes, 1, bench.ledger);
  REQUIRE(lost.size() == 1);
  CHECK(lost[0].theta == modes[0].theta);
  TestTarget const target = centred(2);
  CHECK(largest_move(target.parameters(), modes[0], lost[0], 0).size() == infinity);
  CHECK(largest_move(target.parameters(), lost[0], modes[0], 0).size() == infinity);
}
