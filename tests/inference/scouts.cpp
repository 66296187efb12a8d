// Scouts reach what chains have not entered, and come back to the density.
#include "inference/chain/scouts.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "inference/chain/mh.hpp"
#include "inference/interruptions.hpp"
#include "search/global/search.hpp"

using namespace sysid;
using namespace sysid::testing;

TEST_CASE("scouts from one place are spread like a normal density when they are back, each round by its own numbers") {
  TestTarget const target({"a", "b"}, {{Prior::normal, 0, 1}, {Prior::normal, 3, 2}}, 1, 0,
                          [](std::vector<double> const&, std::vector<double>& rows) { rows[0] = 0; });
  Ledger ledger;
  Objective const objective = make_objective(target, ObjectiveKind::posterior, 1, 0);
  LaneArray from(2, metropolis::scouts);
  for (int w = 0; w < from.width(); ++w) from(0, w) = 0.01 * w / from.width(), from(1, w) = 3 + 0.01 * (w % 7);
  LaneArray const walked = metropolis::scout(objective, from, 5, 0, ledger);
  REQUIRE(walked.width() == 3 * metropolis::scouts);
  double const means[] = {0, 3}, sds[] = {1, 2};
  for (int p = 0; p < 2; ++p) {
    double mean = 0, square = 0;
    for (double const x : walked.row(p)) mean += x / walked.width();
    for (double const x : walked.row(p)) square += (x - mean) * (x - mean) / walked.width();
    CHECK(std::abs(mean - means[p]) < 0.5 * sds[p]);
    CHECK(std::sqrt(square) > 0.7 * sds[p]);
    CHECK(std::sqrt(square) < 1.5 * sds[p]);
  }
  // What it takes besides the look at the places, which the caller has.
  CHECK(ledger.solves() <= metropolis::cost_of_scouts(2));
  CHECK(2 * ledger.solves() > metropolis::cost_of_scouts(2));
  LaneArray const again = metropolis::scout(objective, from, 5, 0, ledger),
                  other = metropolis::scout(objective, from, 5, 1, ledger);
  bool same = true, differs = false;
  for (int w = 0; w < walked.width(); ++w) {
    same = same && walked(0, w) == again(0, w);
    differs = differs || walked(0, w) != other(0, w);
  }
  CHECK(same);
  CHECK(differs);
}

TEST_CASE("a run that is given up while scouts are on their way resumes to the same bytes") {
  // A product known to a tenth: no mixture accepts most of its draws.
  TestTarget const target(
      {"s", "z"}, {{Prior::normal, 0, 1.5}, {Prior::normal, 0, 1}}, 1, 0,
      [](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = (elementary::exp(w[0]) * w[1] - 0.3) / 0.1; });
  Settings settings(mh::settings());
  settings.set("samples", std::int64_t{15000});
  settings.set("burn_in", std::int64_t{2000});
  settings.set("chains", std::int64_t{3});
  GivenUp const searched(target, -1), never(target, -1);
  Bench search_alone(interrupted_seed);
  search(searched, ObjectiveKind::posterior, search_alone.context);
  Unbroken const whole = unbroken(mh::run, never, settings);
  REQUIRE(whole.last.at("independence").at("scoutings").at(0).get<int>() >= 1);
  // Half of the scouts move at once; three chains fill no such batch.
  auto const first = std::find(never.widths.begin() + searched.batches, never.widths.end(), metropolis::scouts / 2);
  REQUIRE(first != never.widths.end());
  int const at = static_cast<int>(first - never.widths.begin());
  check_given_up(mh::run, target, settings, {never.batches - at - 1, never.batches - at - 40, never.batches - at - 130});
}
