// Searches on growing records: what is periodic, silent at first or slow is found, at no more than was announced. A mode
// that is lost and not followed is found with one record; a full run makes more of them, for what depends on where a search begins.
#include "search/global/growing_search.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "relative.hpp"
#include "replications.hpp"
#include "search/global/made_record.hpp"
#include "search/global/search.hpp"
#include "search/journal.hpp"
#include "search/stored_values.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

/// What was announced first, and the most that was shown.
struct Announced : SilentProgress {
  std::uint64_t first = 0, most = 0;
  void begin(std::string_view, std::uint64_t of) override {
    if (first == 0) first = of;
    most = std::max(most, of);
  }
  void expect(std::uint64_t of) override { most = std::max(most, of); }
};

struct Grown {
  SearchResult result;
  Ledger ledger;
  std::uint64_t announced = 0;
  nlohmann::json kept = nullptr;
};

Grown search_grown(MadeRecord const& record, ObjectiveKind kind, std::uint64_t seed, nlohmann::json const& stored = nullptr) {
  Grown grown;
  Announced progress;
  RunContext context{.seed = seed, .progress = progress, .ledger = grown.ledger};
  record.calls = 0;
  context.interrupted = [&] { return record.given_up(); };
  nlohmann::json const back = stored.is_null() ? stored : nlohmann::json::from_cbor(nlohmann::json::to_cbor(stored));
  Journal journal([&](nlohmann::json const& steps) { grown.kept = steps; }, 0, back.is_null() ? nullptr : &back);
  context.journal = &journal;
  RowsSeen const whole(record, record.rows);
  ShorterRecords const parts = parts_of(record);
  REQUIRE(worth_growing(whole, parts));
  grown.result = search(whole, kind, context, parts);
  if (!journal.empty()) journal.save();
  grown.announced = progress.first;
  CHECK(progress.most == progress.first);
  return grown;
}

nlohmann::json said_by(Grown const& grown) {
  nlohmann::json modes = nlohmann::json::array();
  for (Mode const& mode : grown.result.modes) modes.push_back(checkpoint::encode(mode));
  return {{"modes", modes}, {"ledger", checkpoint::encode(grown.ledger)}};
}

void check_found(MadeRecord const& record, Grown const& grown) {
  REQUIRE_FALSE(grown.result.modes.empty());
  Mode const& best = grown.result.modes.front();
  for (std::size_t p = 0; p < record.truth.size(); ++p) {
    CAPTURE(record.names[p]);
    CAPTURE(best.declared[p]);
    CHECK(std::fabs(best.declared[p] - record.truth[p]) < 5 * best.sd[p]);
  }
  CHECK(grown.ledger.solves() <= grown.announced);
}

}  // namespace

TEST_CASE("a period is found where every wrong one scores worse than none") {
  for (std::uint64_t const seed : seeds(2, 6, 0)) {
    CAPTURE(seed);
    MadeRecord const record = make_record(oscillation(), seed);
    Grown const grown = search_grown(record, ObjectiveKind::declared_posterior, 100 + seed);
    check_found(record, grown);
    CHECK(grown.announced < 6000);
  }
}

TEST_CASE("rows that show nothing decide nothing") {
  // The input is silent for a third of the record: what it drives is seen only then.
  MadeRecord const driven = {{"gain", "lag", "rate"},
                             {{Prior::log_uniform, 0.01, 100}, {Prior::log_uniform, 10, 1e4}, {Prior::log_uniform, 1e-3, 1}},
                             {2, 300, 0.05},
                             [](std::vector<double> const& w, double t) {
                               double const since = t - 4000;
                               return since < 0 ? 0.0 : w[0] * (1 - std::exp(-since / w[1]) * std::cos(w[2] * since));
                             },
                             12'000,
                             0.1};
  // One part decays over hundreds of rows, the other over ten thousand.
  MadeRecord const slow = {
      {"quick", "quickly", "slow", "slowly"},
      {{Prior::normal, 0, 3}, {Prior::log_uniform, 1, 1000}, {Prior::normal, 0, 3}, {Prior::log_uniform, 1000, 1e5}},
      {1, 200, -2, 15'000},
      [](std::vector<double> const& w, double t) { return w[0] * (1 - std::exp(-t / w[1])) + w[2] * (1 - std::exp(-t / w[3])); },
      20'000,
      0.05};
  for (MadeRecord const* each : {&driven, &slow}) {
    for (std::uint64_t const seed : seeds(1, 5, 0)) {
      CAPTURE(each->names.front());
      CAPTURE(seed);
      MadeRecord const record = make_record(*each, seed);
      check_found(record, search_grown(record, ObjectiveKind::posterior, 10 + seed));
    }
  }
}

TEST_CASE("what later rows show to be better replaces what the first rows were for") {
  // The first rows decay at another rate: a search that believed them would end where only they are explained.
  MadeRecord const fitted = {{"size", "lag", "level"},
                             {{Prior::normal, 0, 3}, {Prior::log_uniform, 1, 1e5}, {Prior::normal, 0, 3}},
                             {1, 1500, 0.5},
                             [](std::vector<double> const& w, double t) { return w[0] * std::exp(-t / w[1]) + w[2]; },
                             6'000,
                             0.1};
  for (std::uint64_t const seed : seeds(1, 3, 0)) {
    CAPTURE(seed);
    MadeRecord const record = make_record(fitted, seed, [&](std::vector<double> const& w, double t) {
      return t < 250 ? -2 * std::exp(-t / 20) - 1 : fitted.curve(w, t);
    });
    Grown const grown = search_grown(record, ObjectiveKind::declared_posterior, seed);
    Bench bench(seed);
    SearchResult const whole = search(RowsSeen(record, record.rows), ObjectiveKind::declared_posterior, bench.context);
    REQUIRE_FALSE(grown.result.modes.empty());
    CHECK(grown.result.modes.front().log_density > whole.modes.front().log_density - 0.01);
    CHECK(grown.ledger.solves() <= grown.announced);
    CHECK(grown.ledger.solves() < bench.ledger.solves() / 2);
  }
}

TEST_CASE("a mode that a coarse solver loses is followed with a finer one") {
  // Half the rate of a chirp: after 10,000 rows the coarse curve is 14 periods away.
  MadeRecord record = oscillation();
  record.slip = 6e-6;
  record.sd = 0.1;
  record.finest = 4;
  for (std::uint64_t const seed : seeds(1, 4, 0)) {
    CAPTURE(seed);
    MadeRecord const made = make_record(record, seed);
    Grown const grown = search_grown(made, ObjectiveKind::posterior, seed);
    CHECK(grown.result.finer >= 1);
    CHECK(grown.result.finer <= 3);
    REQUIRE_FALSE(grown.result.modes.empty());
    CHECK(grown.result.modes.front().declared[0] == relative(0.137, 1e-3));
    MadeRecord stated = make_record(record, seed);
    stated.finest = 0;  // by the user
    CHECK(search_grown(stated, ObjectiveKind::posterior, seed).result.finer == 0);
  }
}

TEST_CASE("two modes of a long record are both found") {
  // The sign of the rate is not seen.
  MadeRecord record = oscillation();
  record.priors[0] = {Prior::normal, 0, 0.3};
  record.curve = [](std::vector<double> const& w, double t) { return w[1] * std::cos(w[0] * t) + 0.1 * w[2]; };
  record = make_record(record, 3);
  Grown const grown = search_grown(record, ObjectiveKind::posterior, 3);
  REQUIRE(grown.result.modes.size() == 2);
  CHECK(grown.result.modes[0].declared[0] == relative(-grown.result.modes[1].declared[0], 1e-3));
}

TEST_CASE("a search on growing records that is interrupted anywhere goes on to the same bytes") {
  MadeRecord record = make_record(oscillation(), 1);
  Grown const whole = search_grown(record, ObjectiveKind::posterior, 7);
  nlohmann::json const expected = said_by(whole);
  int const calls = record.calls;
  for (int call = 1; call < calls; call += 1 + calls / replications(3, 12)) {
    CAPTURE(call);
    record.last = call;
    Grown const first = search_grown(record, ObjectiveKind::posterior, 7);
    REQUIRE(first.result.interrupted);
    record.last = std::numeric_limits<int>::max();
    CHECK(said_by(search_grown(record, ObjectiveKind::posterior, 7, first.kept)) == expected);
  }
}

TEST_CASE("short records and few numbers are searched as a whole") {
  MadeRecord record = oscillation();
  record.rows = 400;
  record = make_record(record, 1);
  CHECK_FALSE(worth_growing(RowsSeen(record, 400), parts_of(record)));
  CHECK_FALSE(worth_growing(RowsSeen(record, 400), {}));
}
