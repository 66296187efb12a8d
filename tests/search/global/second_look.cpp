// A second search where the best mode leaves motion: it finds the period that the whole record hides, and says nothing where there
// is none to be found.
#include "search/global/second_look.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "relative.hpp"
#include "replications.hpp"
#include "search/global/made_record.hpp"
#include "search/global/search.hpp"
#include "search/journal.hpp"
#include "search/refit.hpp"
#include "search/stored_values.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

MadeRecord short_record() {
  MadeRecord record = oscillation();
  record.rows = 400;
  return record;
}

/// Where a local search from `declared` ends.
Mode mode_near(MadeRecord const& record, std::vector<double> const& declared, std::uint64_t seed) {
  Bench bench(seed);
  Mode from;
  for (std::size_t p = 0; p < declared.size(); ++p) from.theta.push_back(record.priors[p].unconstrain(declared[p]));
  from.declared = declared;
  return refit(RowsSeen(record, record.rows), ObjectiveKind::posterior, {from}, seed, bench.ledger).front();
}

std::optional<GrownModes> look(MadeRecord const& record, Mode const& known, Bench& bench, bool ordered = true) {
  ShorterRecords parts = parts_of(record);
  parts.ordered = ordered;
  return second_look(RowsSeen(record, record.rows), ObjectiveKind::posterior, parts, bench.context, {known});
}

/// By a coarse solver that overflows around the right rate.
class Overflowing : public RowsSeen {
 public:
  explicit Overflowing(MadeRecord const& record) : RowsSeen(record, record.rows), rate_(record.priors[0]) {}
  void residuals(ConstLanes theta, Lanes out, Ledger& ledger) const override {
    RowsSeen::residuals(theta, out, ledger);
    for (int w = 0; w < out.width(); ++w)
      if (double const rate = rate_.constrain(theta(0, w)); rate > 0.1 && rate < 0.2)
        for (int r = 0; r < out.rows(); ++r) out(r, w) = infinity;
  }

 private:
  Prior rate_;
};

std::vector<double> const wrong_period = {0.4, 0.2, 3};

}  // namespace

TEST_CASE("residuals that are correlated leave motion, outliers and white noise do not") {
  MadeRecord record = make_record(short_record(), 1);
  Mode const right = mode_near(record, record.truth, 1), wrong = mode_near(record, wrong_period, 1);
  CHECK_FALSE(leaves_motion(RowsSeen(record, record.rows), right));
  CHECK(leaves_motion(RowsSeen(record, record.rows), wrong));
  record.samples[100] = record.samples[101] = 1e4;  // two samples that carry all of the sum of squares
  CHECK_FALSE(leaves_motion(RowsSeen(record, record.rows), right));
  CHECK(leaves_motion(RowsSeen(record, record.rows), wrong));
  // Correlated with the other sign: every other sample lies above.
  MadeRecord const alternating = make_record(short_record(), 2, [](std::vector<double> const& w, double t) {
    return w[1] * std::sin(w[0] * t + w[2]) + (std::fmod(t, 2) < 1 ? 0.5 : -0.5);
  });
  CHECK(leaves_motion(RowsSeen(alternating, alternating.rows), mode_near(alternating, alternating.truth, 1)));
}

TEST_CASE("the right period replaces a wrong one") {
  for (std::uint64_t const seed : seeds(2, 6, 0)) {
    CAPTURE(seed);
    MadeRecord const record = make_record(short_record(), seed);
    Bench bench(seed);
    auto const found = look(record, mode_near(record, wrong_period, seed), bench);
    REQUIRE(found);
    CHECK(found->finer == 0);
    CHECK(found->modes.front().declared[0] == relative(0.137, 5e-3));
  }
}

TEST_CASE("where the best mode is known, no other one is reported") {
  MadeRecord const record = make_record(short_record(), 3);
  Bench bench(3);
  CHECK_FALSE(look(record, mode_near(record, record.truth, 3), bench));
  CHECK(bench.ledger.solves() == 0);  // nor looked for: it leaves no motion
  // Of a model that lacks something, the search is made in vain.
  MadeRecord const lacking = make_record(short_record(), 3, [](std::vector<double> const& w, double t) {
    return w[1] * std::sin(w[0] * t + w[2]) + 0.5 * std::sin(0.05 * t);
  });
  CHECK_FALSE(look(lacking, mode_near(lacking, lacking.truth, 3), bench));
  CHECK(bench.ledger.solves() > 0);
}

TEST_CASE("rows without an order, or few of them, have no period to be missed") {
  MadeRecord record = make_record(short_record(), 4);
  Bench bench(4);
  CHECK_FALSE(look(record, mode_near(record, wrong_period, 4), bench, false));
  record.rows = 100;
  CHECK_FALSE(look(record, mode_near(record, wrong_period, 4), bench));
  CHECK(bench.ledger.solves() == 0);
}

TEST_CASE("densities of two solvers are not compared") {
  // With the coarse curve alone a mode is high, and it leaves some motion: with the finer one it is no lower than what a second
  // search finds.
  MadeRecord record = short_record();
  record.finest = 4;
  record =
      make_record(record, 5, [&](std::vector<double> const& w, double t) { return record.curve(w, t) + 0.3 * std::sin(0.05 * t); });
  record.slip = 1e-5;
  Bench bench(5);
  CHECK_FALSE(look(record, mode_near(record, record.truth, 5), bench));
}

TEST_CASE("modes that are lost with the solver of the first search keep the finer one") {
  MadeRecord record = short_record();
  record.finest = 4;
  record = make_record(record, 5);
  Mode const known = mode_near(record, wrong_period, 5);
  Bench holds(5);
  auto const held = look(record, known, holds);
  REQUIRE(held);
  CHECK(held->finer == 0);
  Bench bench(5);
  auto const found = second_look(Overflowing(record), ObjectiveKind::posterior, parts_of(record), bench.context, {known});
  REQUIRE(found);
  CHECK(found->finer == 2);
  CHECK(found->modes.front().declared[0] == relative(0.137, 5e-3));
}

TEST_CASE("a second search that is interrupted anywhere goes on to the same bytes") {
  MadeRecord record = make_record(short_record(), 1);
  Mode const known = mode_near(record, wrong_period, 1);
  auto const run = [&](nlohmann::json const& stored, nlohmann::json& kept) -> nlohmann::json {
    Bench bench(7);
    record.calls = 0;
    bench.context.interrupted = [&] { return record.given_up(); };
    nlohmann::json const back = stored.is_null() ? stored : nlohmann::json::from_cbor(nlohmann::json::to_cbor(stored));
    Journal journal([&](nlohmann::json const& steps) { kept = steps; }, 0, back.is_null() ? nullptr : &back);
    bench.context.journal = &journal;
    auto const found = look(record, known, bench);
    if (!journal.empty()) journal.save();
    nlohmann::json modes = nlohmann::json::array();
    if (found)
      for (Mode const& mode : found->modes) modes.push_back(checkpoint::encode(mode));
    return {{"modes", modes}, {"ledger", checkpoint::encode(bench.ledger)}};
  };
  nlohmann::json kept;
  nlohmann::json const expected = run(nullptr, kept);
  REQUIRE_FALSE(expected.at("modes").empty());
  int const calls = record.calls;
  for (int call = 1; call < calls; call += 1 + calls / replications(6, 20)) {
    CAPTURE(call);
    record.last = call;
    nlohmann::json part;
    CHECK(run(nullptr, part).at("modes").empty());
    record.last = std::numeric_limits<int>::max();
    CHECK(run(part, kept) == expected);
  }
}
