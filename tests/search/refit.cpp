// Modes followed to a neighbouring target.
#include "search/refit.hpp"

#include <doctest/doctest.h>

#include "inference/targets.hpp"
#include "relative.hpp"
#include "search/global/search.hpp"
#include "search/mode/moves.hpp"

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
  CHECK(gains[0] == relative(0.125, 1e-3));
  sysid::Move const move = largest_move(target.parameters(), modes[0], moved[0], gains[0]);
  CHECK(move.value == doctest::Approx(0.5).epsilon(1e-3));
  CHECK(move.size() == doctest::Approx(0.5).epsilon(1e-2));
  // Where nothing is gained, the sd is wrong, and there is no move.
  CHECK(largest_move(target.parameters(), modes[0], moved[0], 0).size() == 0);
  CHECK(moved[0].share == modes[0].share);
  CHECK(refit(centred(2), ObjectiveKind::posterior, {}, 1, bench.ledger).empty());
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
