// Searches on growing records: what is periodic, silent at first or slow is found, at no more than was announced. A mode
// that is lost and not followed is found with one record; a full run makes more of them, for what depends on where a search begins.
#include "search/growing_search.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "inference/targets.hpp"
#include "replications.hpp"
#include "search/journal.hpp"
#include "search/search.hpp"
#include "search/stored_values.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

/// A record at unit steps with normal noise of known sd, and the curve that is fitted to it.
struct MadeRecord {
  using Curve = std::function<double(std::vector<double> const& w, double t)>;
  std::vector<std::string> names;
  std::vector<Prior> priors;
  std::vector<double> truth;
  Curve curve;
  int rows;
  double sd;
  double slip = 0;  // of the time, by a coarse solver: its part of t^2; each refinement leaves a sixteenth
  int finest = 0;
  std::vector<double> samples = {};
  mutable int calls = 0;
  int last = std::numeric_limits<int>::max();  // call from which on all is given up

  bool given_up() const { return calls >= last; }
};

/// What is seen of it: so many rows.
class RowsSeen : public TestTarget {
 public:
  RowsSeen(MadeRecord const& record, int rows, int finer = 0)
      : TestTarget(record.names, record.priors, rows, 0,
                   [&record, rows, slip = record.slip / std::pow(16, finer)](std::vector<double> const& w, std::vector<double>& r) {
                     for (int i = 0; i < rows; ++i) {
                       auto const at = static_cast<std::size_t>(i);
                       r[at] = (record.samples[at] - record.curve(w, i + slip * i * i)) / record.sd;
                     }
                   }),
        record_(record) {}
  void residuals(ConstLanes theta, Lanes out, Ledger& ledger) const override {
    TestTarget::residuals(theta, out, ledger);
    if (++record_.calls < record_.last) return;
    for (int w = 0; w < out.width(); ++w)
      for (int r = 0; r < out.rows(); ++r) out(r, w) = infinity;
  }

 private:
  MadeRecord const& record_;
};

MadeRecord make_record(MadeRecord record, std::uint64_t seed, MadeRecord::Curve const& made = {}) {
  Stream stream({seed, Purpose::test, 0, 0});
  for (int i = 0; i < record.rows; ++i)
    record.samples.push_back((made ? made : record.curve)(record.truth, i) + record.sd * stream.normal());
  return record;
}

ShorterRecords parts_of(MadeRecord const& record) {
  return {record.rows, record.finest, [&record](double share, int finer) {
            int const rows = static_cast<int>(std::ceil(share * record.rows));
            return FirstPart{std::make_unique<RowsSeen>(record, rows, finer), static_cast<double>(rows) / record.rows};
          }};
}

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

MadeRecord oscillation() {
  return {{"rate", "size", "phase"},
          {{Prior::log_uniform, 1e-3, 1}, {Prior::log_uniform, 0.1, 10}, {Prior::uniform, 0, 6}},
          {0.137, 1, 2},
          [](std::vector<double> const& w, double t) { return w[1] * std::sin(w[0] * t + w[2]); },
          10'000,
          0.3};
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
    for (std::uint64_t const seed : seeds(2, 5, 0)) {
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
                             {1, 3000, 0.5},
                             [](std::vector<double> const& w, double t) { return w[0] * std::exp(-t / w[1]) + w[2]; },
                             12'000,
                             0.1};
  for (std::uint64_t const seed : seeds(1, 3, 0)) {
    CAPTURE(seed);
    MadeRecord const record = make_record(fitted, seed, [&](std::vector<double> const& w, double t) {
      return t < 500 ? -2 * std::exp(-t / 40) - 1 : fitted.curve(w, t);
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
    CHECK(grown.result.modes.front().declared[0] == doctest::Approx(0.137).epsilon(1e-3));
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
  CHECK(grown.result.modes[0].declared[0] == doctest::Approx(-grown.result.modes[1].declared[0]).epsilon(1e-3));
}

TEST_CASE("a search on growing records that is interrupted anywhere goes on to the same bytes") {
  MadeRecord record = make_record(oscillation(), 1);
  Grown const whole = search_grown(record, ObjectiveKind::posterior, 7);
  nlohmann::json const expected = said_by(whole);
  int const calls = record.calls;
  for (int call = 1; call < calls; call += 1 + calls / replications(5, 12)) {
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
