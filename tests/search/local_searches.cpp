// Local searches from given places: each mode once, searches that meet counted and not paid for twice.
#include "search/local_searches.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "inference/targets.hpp"
#include "relative.hpp"
#include "search/global/search.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

/// A density with a peak of sd 0.1 at 2 and one at -2 under a prior of sd 3.
TestTarget two_peaks() {
  return TestTarget({"x"}, {{Prior::normal, 0, 3}}, 1, 0, [](std::vector<double> const& x, std::vector<double>& rows) {
    rows[0] = (x[0] * x[0] - 4) / 0.4;  // slope 4 / 0.4 at the peaks
  });
}

LaneArray at(std::vector<double> const& places) {
  LaneArray starts(1, static_cast<int>(places.size()));
  for (std::size_t w = 0; w < places.size(); ++w) starts(0, static_cast<int>(w)) = places[w];
  return starts;
}

}  // namespace

TEST_CASE("each mode that searches end in comes once, with the number of searches that did") {
  TestTarget const target = two_peaks();
  Ledger ledger;
  std::vector<Mode> const modes =
      modes_from(target, ObjectiveKind::posterior, at({1.5, 3, 1.9, -2.5, 2.2}), -infinity, 1, ledger).modes;
  REQUIRE(modes.size() == 2);
  CHECK(modes[0].hits + modes[1].hits == 5);
  for (Mode const& mode : modes) {
    CHECK(mode.hits == (mode.declared[0] > 0 ? 4 : 1));
    CHECK(std::fabs(mode.declared[0]) == doctest::Approx(2).epsilon(0.01));
    CHECK(mode.sd[0] == relative(0.1, 0.02));
    CHECK(mode.share == doctest::Approx(0.5).epsilon(0.01));
  }
}

TEST_CASE("a mode met once may have a neighbour that was missed, whatever was met elsewhere") {
  auto const mode = [](double log_density, int hits) {
    Mode one;
    one.log_density = log_density;
    one.hits = hits;
    return one;
  };
  CHECK(may_be_missed({mode(0, 1), mode(-5, 9)}, 10));
  CHECK_FALSE(may_be_missed({mode(0, 5), mode(-5, 5)}, 10));
  // Ranked by mass: the narrow one is higher, and says nothing of the broad one.
  CHECK(may_be_missed({mode(0, 1), mode(4, 9)}, 10));
  // Two copies with another mode between them in the order of mass are one place, and met as often as both.
  CHECK_FALSE(may_be_missed({mode(0, 1), mode(-5, 8), mode(0, 1)}, 10));
  // But many of one height are as many places as they are.
  std::vector<Mode> const many(20, mode(0, 2));
  CHECK(may_be_missed(many, 64));
  CHECK_FALSE(may_be_missed(many, 200));
}

TEST_CASE(
    "more searches go on to their ends after a pass that had a high mode for each, not where the passes together have as many") {
  TestTarget const target = two_peaks();
  Objective const objective = make_objective(target, ObjectiveKind::posterior, 1, 0);
  std::vector<Mode> modes;
  std::vector<Climber> ends;
  for (int k = 0; k < 8; ++k) {
    double const height = k < 6 ? 0 : -10;  // the last two of eight are of little mass
    modes.push_back({});
    modes.back().log_density = height;
    ends.push_back(climber_at(Eigen::VectorXd::Constant(1, k), height));
    ends.back().curvature = Eigen::MatrixXd::Identity(1, 1);
  }
  auto const pass = [&](int from, int count) { return std::vector<Climber>(ends.begin() + from, ends.begin() + from + count); };
  CHECK(next_finalists(objective, modes, pass(0, 4), 4, 100) == 8);
  CHECK(next_finalists(objective, modes, pass(0, 4), 4, 6) == 6);
  CHECK(next_finalists(objective, modes, pass(0, 3), 4, 100) == 4);  // fewer starts than that could be solved
  CHECK(next_finalists(objective, modes, pass(4, 4), 4, 100) == 4);  // half of them low
  std::vector<Climber> met = pass(0, 4);
  met[3] = met[0];
  CHECK(next_finalists(objective, modes, met, 4, 100) == 4);  // two in one place, though six high modes are known
  CHECK(next_finalists(objective, {modes.begin(), modes.begin() + 3}, pass(0, 4), 4, 100) == 4);  // the ends are of three modes
  CHECK(next_finalists(objective, {}, {}, 4, 100) == 4);
}

TEST_CASE("nineteen modes of one height are all found, with equal shares") {
  TestTarget const target({"f"}, {{Prior::uniform, 2.5, 97.5}}, 1, 0, [](std::vector<double> const& x, std::vector<double>& rows) {
    rows[0] = std::sin(std::numbers::pi * x[0] / 5) / 0.1;
  });
  for (ObjectiveKind const kind : {ObjectiveKind::posterior, ObjectiveKind::likelihood}) {
    Bench bench(1);
    SearchResult const result = search(target, kind, bench.context);
    CHECK(result.modes.size() == 19);
    for (Mode const& each : result.modes) CHECK(each.share == relative(1.0 / 19, 0.05));
  }
}

TEST_CASE("searches that meet go on as one: eight cost little more than one") {
  TestTarget const target = duffing(3);
  Ledger ledger;
  LaneArray one(target.dimension(), 1), eight(target.dimension(), 8);
  Bench bench(1);
  std::vector<double> const best = search(target, ObjectiveKind::posterior, bench.context).modes.front().declared;
  LaneArray declared(target.dimension(), 8), theta = declared;
  for (int w = 0; w < 8; ++w)
    for (int p = 0; p < target.dimension(); ++p)
      declared(p, w) = best[static_cast<std::size_t>(p)] * (1 + 0.001 * (w - 3) * (p % 2 == 0 ? 1 : -1));
  target.unconstrain(declared, eight);
  for (int p = 0; p < target.dimension(); ++p) one(p, 0) = eight(p, 0);
  target.solves = 0;
  std::vector<Mode> const of_one = modes_from(target, ObjectiveKind::posterior, one, -infinity, 1, ledger).modes;
  std::uint64_t const cost_of_one = target.solves;
  target.solves = 0;
  std::vector<Mode> const of_eight = modes_from(target, ObjectiveKind::posterior, eight, -infinity, 1, ledger).modes;
  REQUIRE(of_one.size() == 1);
  REQUIRE(of_eight.size() == 1);
  CHECK(of_eight[0].hits == 8);
  CHECK(of_eight[0].log_mass == doctest::Approx(of_one[0].log_mass).epsilon(1e-6));
  CHECK(target.solves < 3 * cost_of_one);
}

TEST_CASE("a start without a finite density is left out, and nothing is found from none") {
  TestTarget const target({"x"}, {{Prior::normal, 0, 3}}, 1, 0, [](std::vector<double> const& x, std::vector<double>& rows) {
    rows[0] = x[0] < 0 ? std::numeric_limits<double>::quiet_NaN() : (x[0] - 2) / 0.1;
  });
  Ledger ledger;
  std::vector<Mode> const modes = modes_from(target, ObjectiveKind::posterior, at({-1, 2.5, -3}), -infinity, 1, ledger).modes;
  REQUIRE(modes.size() == 1);
  CHECK(modes[0].hits == 1);
  CHECK(modes_from(target, ObjectiveKind::posterior, at({-1, -3}), -infinity, 1, ledger).modes.empty());
}

TEST_CASE("a search that cannot come to the mass that is asked for is given up, one that can is not") {
  TestTarget const target = duffing(3);
  Bench bench(1);
  Mode const best = search(target, ObjectiveKind::posterior, bench.context).modes.front();
  LaneArray starts(target.dimension(), 4);
  target.sample_prior({1, Purpose::test, 0, 0}, starts);
  for (int p = 0; p < target.dimension(); ++p) starts(p, 0) = best.theta[static_cast<std::size_t>(p)] + 0.05;
  Ledger ledger;
  target.solves = 0;
  LocalSearches const reached = modes_from(target, ObjectiveKind::posterior, starts, best.log_mass - 1, 1, ledger);
  std::uint64_t const whole = target.solves;
  CHECK_FALSE(reached.given_up);
  CHECK(reached.modes.front().log_mass == doctest::Approx(best.log_mass).epsilon(1e-4));
  target.solves = 0;
  LocalSearches const missed = modes_from(target, ObjectiveKind::posterior, starts, best.log_mass + 1000, 1, ledger);
  CHECK(missed.given_up);
  REQUIRE(missed.modes.size() == 1);
  CHECK(missed.modes.front().log_mass < best.log_mass + 1000);
  CHECK(target.solves <= whole);
}
