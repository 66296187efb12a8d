// Moves along ridges and sheets: they leave the density as it is, and cross what walks do not cross.
#include "inference/chain/ridge_moves.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "inference/chain/mh.hpp"
#include "inference/interruptions.hpp"
#include "replications.hpp"
#include "search/objective.hpp"

using namespace sysid;
using namespace sysid::testing;
using namespace sysid::metropolis;

namespace {

/// c = a^2 - b to a hundredth, a and b from standard normal distributions: a bent sheet.
TestTarget sheet() {
  return TestTarget({"a", "b", "c"}, {{Prior::normal, 0, 1}, {Prior::normal, 0, 1}, {Prior::normal, 0, 100}}, 1, 0,
                    [](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = (w[2] - w[0] * w[0] + w[1]) / 0.01; });
}

/// The product of three uniform factors is known to a thousandth.
TestTarget product_of_three() {
  Prior const each{Prior::uniform, 0.1, 10};
  return TestTarget({"a", "b", "c"}, {each, each, each}, 1, 0,
                    [](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = (w[0] * w[1] * w[2] - 1) / 0.001; });
}

RidgeMoves moves_of(Target const& target) { return RidgeMoves(make_objective(target, ObjectiveKind::posterior, 1, 0).scale); }

/// Chi-square of counts in ten bins that are equally probable; values: uniform between 0 and 1.
double chi_square(std::vector<double> const& values) {
  std::vector<double> counts(10);
  for (double const v : values) ++counts[std::min<std::size_t>(9, static_cast<std::size_t>(10 * v))];
  double const expected = static_cast<double>(values.size()) / 10;
  double sum = 0;
  for (double const n : counts) sum += (n - expected) * (n - expected) / expected;
  return sum;
}

double normal_probability(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

/// Exact draws of `sheet`, up to the prior of c, which is flat there.
LaneArray draws_of_sheet(int count) {
  LaneArray theta(3, count);
  for (int w = 0; w < count; ++w) {
    Stream stream({21, Purpose::test, static_cast<std::uint64_t>(w), 0});
    theta(0, w) = stream.normal();
    theta(1, w) = stream.normal();
    theta(2, w) = theta(0, w) * theta(0, w) - theta(1, w) + 0.01 * stream.normal();
  }
  return theta;
}

}  // namespace

TEST_CASE("moves along a sheet leave draws of its density distributed as they are") {
  TestTarget const target = sheet();
  RidgeMoves const moves = moves_of(target);
  constexpr int chains = 3000;
  Ledger ledger;
  State state = init(target, draws_of_sheet(chains), ledger);
  LaneArray const before = state.theta;
  int accepted = 0;
  for (std::uint64_t step = 0; step < 6; ++step)
    for (Move const& move : moves.step(target, {5, Purpose::proposal, 0, step}, state, ledger)) accepted += move.accepted;
  MESSAGE("accepted " << accepted / (6.0 * chains));
  CHECK(accepted > 0.3 * 6 * chains);
  std::vector<double> a, b, across;
  int moved = 0;
  for (int w = 0; w < chains; ++w) {
    a.push_back(normal_probability(state.theta(0, w)));
    b.push_back(normal_probability(state.theta(1, w)));
    across.push_back(normal_probability((state.theta(2, w) - state.theta(0, w) * state.theta(0, w) + state.theta(1, w)) / 0.01));
    moved += std::fabs(state.theta(0, w) - before(0, w)) > 0.3;
  }
  CHECK(moved > chains / 2);
  // 9 degrees of freedom: exceeded once in 10,000 times.
  CHECK(chi_square(a) < 33.7);
  CHECK(chi_square(b) < 33.7);
  CHECK(chi_square(across) < 33.7);
}

TEST_CASE("a move along a sheet depends on its chain alone") {
  TestTarget const target = sheet();
  RidgeMoves const moves = moves_of(target);
  constexpr int chains = 7;
  Ledger ledger;
  State all = init(target, draws_of_sheet(chains), ledger);
  std::vector<State> alone;
  for (int w = 0; w < chains; ++w) {
    LaneArray one(3, 1);
    for (int p = 0; p < 3; ++p) one(p, 0) = all.theta(p, w);
    alone.push_back(init(target, std::move(one), ledger));
  }
  for (std::uint64_t step = 0; step < 4; ++step) {
    moves.step(target, {5, Purpose::proposal, 0, step}, all, ledger);
    for (int w = 0; w < chains; ++w) {
      moves.step(target, {5, Purpose::proposal, static_cast<std::uint64_t>(w), step}, alone[static_cast<std::size_t>(w)], ledger);
      for (int p = 0; p < 3; ++p) CHECK(all.theta(p, w) == alone[static_cast<std::size_t>(w)].theta(p, 0));
    }
  }
}

TEST_CASE("chains whose independence moves do not reach all of a sheet move along it, and resume to the same bytes") {
  TestTarget const target = product_of_three();
  Settings settings(mh::settings());
  settings.set("samples", std::int64_t{16000});
  settings.set("burn_in", std::int64_t{4000});
  Unbroken const whole = unbroken(mh::run, target, settings);
  CHECK(whole.last.at("ridge").at("steps").get<std::uint64_t>() > 0);
  for (Summary const& each : summarise(whole.result)) {
    MESSAGE(each.name << " sd " << each.sd << " R-hat " << each.rhat << " effective draws " << each.ess_bulk);
    CHECK(each.rhat < 1.01);
    CHECK(each.ess_bulk > 400);
  }
  int const end = whole.questions;
  check_stops(mh::run, target, settings, whole,
              full_size() ? std::vector<int>{end - 1, end / 2, end / 4} : std::vector<int>{end / 2});
}
