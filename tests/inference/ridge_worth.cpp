// Whether moves along ridges are worth their simulations, from jumps of known size.
#include "inference/chain/ridge_worth.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "inference/backend/checkpoint.hpp"

using namespace sysid;
using namespace sysid::metropolis;

namespace {

struct Made {
  MoveKind kind;
  double log_weight, jump, other_jump = 0;  // of the first parameter and of the second
};

/// One chain of two parameters makes these moves, each at this many simulations.
void make(RidgeWorth& worth, std::vector<Made> const& moves, std::uint64_t simulations) {
  for (Made const& made : moves) {
    LaneArray before(2, 1), after(2, 1);
    after(0, 0) = made.jump;
    after(1, 0) = made.other_jump;
    worth.learn(before, std::vector<double>{made.log_weight}, after, {Move{.kind = made.kind}});
    worth.spend(made.kind == MoveKind::ridge, simulations);
  }
}

/// Windows in which both kinds start from a state that the mixture reaches and from one of 1e6 times its weight, and jump as given.
RidgeWorth windows(int count, double common_ridge, double rare_ridge, double common_other, double rare_other) {
  RidgeWorth worth;
  for (int k = 0; k < count; ++k) {
    make(worth, {{MoveKind::ridge, 5400, common_ridge}, {MoveKind::ridge, 5413.8, rare_ridge}}, 100);
    make(worth, {{MoveKind::independent, 5400, common_other}, {MoveKind::walk, 5413.8, rare_other}}, 1);
    worth.end_window();
  }
  return worth;
}

}  // namespace

TEST_CASE("jumps out of states that the mixture hardly reaches decide whether moves along ridges are worth it") {
  // 100 simulations a move: a squared jump must be a hundred times as large.
  CHECK(windows(2, 0.1, 1, 10, 0.05).worth());
  CHECK_FALSE(windows(2, 10, 1, 0.01, 0.2).worth());
  CHECK_FALSE(windows(2, 0, 0, 1, 1).worth());
  CHECK(windows(2, 0, 1, 1, 0).worth());
  CHECK(windows(1, 0, 0, 1, 1).worth());  // one window does not decide
}

TEST_CASE("one parameter that only moves along ridges carry far is enough, and one window does not turn the others") {
  RidgeWorth worth;
  auto const window = [&](double ridge_second) {
    make(worth, {{MoveKind::ridge, 0, 0.1, ridge_second}}, 100);
    make(worth, {{MoveKind::walk, 0, 1, 0.01}}, 1);
    worth.end_window();
  };
  window(1);  // r = 100
  window(1);
  CHECK(worth.worth());
  window(0);  // r = 1e-4, counted as 1e-3: with those before 10^(4 - 3)
  CHECK(worth.worth());
  window(0);
  CHECK_FALSE(worth.worth());
}

TEST_CASE("states without a weight, and windows of one kind, say nothing") {
  RidgeWorth worth;
  for (int k = 0; k < 3; ++k) {
    make(worth, {{MoveKind::ridge, std::numeric_limits<double>::quiet_NaN(), 0}}, 100);
    make(worth, {{MoveKind::walk, 0, 1}}, 1);
    worth.end_window();
  }
  CHECK(worth.worth());
}

TEST_CASE("what is known of moves along ridges is stored and restored whole, or refused") {
  RidgeWorth worth = windows(3, 1, 2, 3, 4);
  make(worth, {{MoveKind::ridge, 1, 2, 3}}, 7);
  nlohmann::json const stored = worth.store();
  CHECK(RidgeWorth::restore(stored, 2).store() == stored);
  CHECK(RidgeWorth::restore(RidgeWorth().store(), 2).store() == RidgeWorth().store());
  CHECK_THROWS_AS(RidgeWorth::restore(stored, 3), checkpoint::Mismatch);
  nlohmann::json short_of_counts = stored;
  short_of_counts["counts"] = {1, 2};
  CHECK_THROWS_AS(RidgeWorth::restore(short_of_counts, 2), checkpoint::Mismatch);
}
