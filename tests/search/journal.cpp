// A search that is interrupted anywhere goes on to the bytes of one that was not.
#include "search/journal.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

#include "inference/targets.hpp"
#include "replications.hpp"
#include "search/global/search.hpp"
#include "search/refit.hpp"
#include "search/stored_values.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

using json = nlohmann::json;

/// Several hills in x, a bounded y, failures in a corner. From the call on that is named, in its middle, all it says is worthless:
/// so do simulations that are given up.
class Fragile : public TestTarget {
 public:
  explicit Fragile(bool gradient, int last = std::numeric_limits<int>::max())
      : TestTarget({"x", "y"}, {{Prior::normal, 0, 3}, {Prior::uniform, 0, 4}}, 4, 0, &rows_at), gradient_(gradient), last_(last) {}

  int calls() const { return calls_; }
  bool stopped() const { return calls_ >= last_; }

  bool is_expensive() const override { return gradient_; }
  void residuals(ConstLanes theta, Lanes out, Ledger& ledger) const override {
    TestTarget::residuals(theta, out, ledger);
    if (++calls_ < last_) return;
    ledger.add_failure(FailureClass::non_finite, "given up", 0, {});
    for (int w = 0; w < out.width(); ++w)
      for (int r = 0; r < out.rows(); ++r) out(r, w) = infinity;
  }
  void log_likelihood_gradient(ConstLanes theta, std::span<double> out, Lanes gradient, Ledger& ledger) const override {
    constexpr double h = 1e-5;
    LaneArray points(2, 5), rows(4, 5);
    for (int w = 0; w < 5; ++w)
      for (int p = 0; p < 2; ++p) points(p, w) = theta(p, 0) + (w == 1 + 2 * p ? h : w == 2 + 2 * p ? -h : 0);
    residuals(points, rows, ledger);
    auto const value = [&](int w) {
      double sum = 0;
      for (int r = 0; r < 4; ++r) sum += rows(r, w) * rows(r, w);
      return -0.5 * sum;
    };
    for (int p = 0; p < 2; ++p) gradient(p, 0) = (value(1 + 2 * p) - value(2 + 2 * p)) / (2 * h);
    out[0] = value(0);
  }

 private:
  static void rows_at(std::vector<double> const& w, std::vector<double>& rows) {
    double const x = w[0], y = w[1];
    rows = {2 * std::sin(2 * x) - 1 + 0.1 * x, 0.3 * (x - 1), 3 * (y - 3.9 + 0.2 * x), x > 6 ? infinity : 0.1 * x * y};
  }

  bool gradient_;
  int last_;
  mutable int calls_ = 0;
};

/// Of one search: what it found, what it counted, what it cost.
struct Searched {
  SearchResult result;
  Ledger ledger;
  int calls = 0;
  json kept;  // null: nothing
};

/// stored: what an earlier one has kept, through CBOR; null: nothing.
Searched run(ObjectiveKind kind, bool gradient, int last, json const& stored, bool with_journal = true) {
  Searched searched;
  Fragile const target(gradient, last);
  SilentProgress silent;
  RunContext context{.seed = 3, .progress = silent, .ledger = searched.ledger};
  context.interrupted = [&] { return target.stopped(); };
  json const back = stored.is_null() ? json() : json::from_cbor(json::to_cbor(stored));
  Journal journal([&](json const& steps) { searched.kept = steps; }, 0, back.is_null() ? nullptr : &back);
  if (with_journal) context.journal = &journal;
  searched.result = search(target, kind, context);
  searched.kept = nullptr;
  if (!journal.empty()) journal.save();
  searched.calls = target.calls();
  return searched;
}

/// All that a search says, bit for bit.
json all_of(Searched const& searched) {
  json modes = json::array();
  for (Mode const& mode : searched.result.modes) modes.push_back(checkpoint::encode(mode));
  return {{"modes", modes},
          {"findings", checkpoint::encode(searched.result.findings)},
          {"ledger", checkpoint::encode(searched.ledger)}};
}

constexpr int never = std::numeric_limits<int>::max();
// Calls of the longest work that is not taken up in its middle; of a likelihood, ridges are followed, too.
constexpr int of_a_mode = 65, with_ridges = 170;

}  // namespace

TEST_CASE("a search that is interrupted anywhere goes on to the same bytes, and does little twice") {
  for (ObjectiveKind const kind : {ObjectiveKind::posterior, ObjectiveKind::declared_posterior, ObjectiveKind::likelihood}) {
    for (bool const gradient : {false, true}) {
      Searched const whole = run(kind, gradient, never, nullptr, false);
      REQUIRE(whole.result.modes.size() > 1);
      CHECK(all_of(run(kind, gradient, never, nullptr)) == all_of(whole));
      for (int call = 1; call < whole.calls; call += 1 + whole.calls / replications(12, 40)) {
        CAPTURE(static_cast<int>(kind));
        CAPTURE(gradient);
        CAPTURE(call);
        Searched const first = run(kind, gradient, call, nullptr);
        REQUIRE(first.result.interrupted);
        Searched const rest = run(kind, gradient, never, first.kept);
        CHECK(all_of(rest) == all_of(whole));
        // By a gradient a whole local search is what may be lost.
        if (!gradient) CHECK(rest.calls + call <= whole.calls + (kind == ObjectiveKind::likelihood ? with_ridges : of_a_mode));
        if (gradient && call > whole.calls / 2) CHECK(rest.calls < whole.calls);
      }
    }
  }
}

TEST_CASE("a search that is interrupted again and again comes to its end") {
  Searched const whole = run(ObjectiveKind::posterior, false, never, nullptr, false);
  json kept;
  int times = 0;
  for (; times < 200; ++times) {
    Searched const part = run(ObjectiveKind::posterior, false, of_a_mode + 5, kept);
    if (!part.result.interrupted) {
      CHECK(all_of(part) == all_of(whole));
      break;
    }
    kept = part.kept;
  }
  CHECK(times >= 2);
  CHECK(times < 200);
}

TEST_CASE("modes followed to another target are kept, too") {
  auto const follow = [](int last, json const& stored, json& kept, Ledger& ledger) {
    Fragile const target(false, last);
    Ledger of_search;
    SilentProgress silent;
    RunContext context{.seed = 3, .progress = silent, .ledger = of_search};
    Fragile const before(false);
    std::vector<Mode> modes = search(before, ObjectiveKind::posterior, context).modes;
    for (Mode& mode : modes) mode.theta[0] += 0.05;
    Journal journal([&](json const& steps) { kept = steps; }, 0, stored.is_null() ? nullptr : &stored);
    std::vector<double> gains;
    modes = refit(
        target, ObjectiveKind::posterior, modes, 3, ledger, [&] { return target.stopped(); }, &gains, &journal);
    json all = {{"gains", checkpoint::encode(std::span<double const>(gains))}, {"calls", target.calls()}};
    for (Mode const& mode : modes) all["modes"].push_back(checkpoint::encode(mode));
    kept = nullptr;
    if (!journal.empty()) journal.save();
    return all;
  };
  json kept, ignored;
  Ledger of_whole;
  json whole = follow(never, nullptr, ignored, of_whole);
  int const calls = whole.at("calls").get<int>();
  whole.erase("calls");
  for (int call = 1; call < calls; call += 2) {
    CAPTURE(call);
    Ledger first, second;
    follow(call, nullptr, kept, first);
    json rest = follow(never, kept, ignored, second);
    rest.erase("calls");
    CHECK(rest == whole);
    CHECK(checkpoint::encode(second) == checkpoint::encode(of_whole));
  }
}

TEST_CASE("a journal of another search, or a damaged one, is refused") {
  Searched const half = run(ObjectiveKind::posterior, false, 60, nullptr);
  REQUIRE(half.kept.at("finished").size() > 1);
  auto const resumed = [](json const& stored) { run(ObjectiveKind::posterior, false, never, stored); };
  CHECK_NOTHROW(resumed(half.kept));
  json other = half.kept;
  other["finished"][1][0] = "settle";
  CHECK_THROWS_AS(resumed(other), checkpoint::Mismatch);
  other = half.kept;
  other["finished"][1][1]["climbers"].erase(0);
  CHECK_THROWS_AS(resumed(other), checkpoint::Mismatch);
  other = half.kept;
  other["finished"][0][1]["values"] = checkpoint::encode(std::vector<double>{1, 2});
  CHECK_THROWS_AS(resumed(other), checkpoint::Mismatch);
  other = half.kept;
  other["finished"] = 3;
  CHECK_THROWS_AS(resumed(other), checkpoint::Mismatch);
  other = half.kept;
  other["finished"][0] = json::array({"densities"});
  CHECK_THROWS_AS(resumed(other), checkpoint::Mismatch);
}

TEST_CASE("a bar does not stand near its end while a search goes on") {
  struct Shares : SilentProgress {
    std::uint64_t total = 1, done = 0, high = 0;  // high: solves done while more than 95 % were shown
    int passes = 0;
    bool was_high = false;
    void begin(std::string_view, std::uint64_t of) override { total = of, ++passes; }
    void expect(std::uint64_t of) override { total = of; }
    void advance(std::uint64_t now, std::string_view) override {
      if (was_high) high += now - done;
      done = now;
      CHECK(done < total);
      was_high = static_cast<double>(done) > 0.95 * static_cast<double>(total);
    }
  };
  // One needle that is met once, if at all, and a broad hill: all passes are made. And a curved valley, which takes many rounds.
  TestTarget const needles({"x"}, {{Prior::normal, 0, 30}}, 1, 500, [](std::vector<double> const& w, std::vector<double>& rows) {
    rows[0] = as_residual(-20 * (1 + std::sin(7 * w[0])) - 1e-3 * w[0] * w[0], 500);
  });
  TestTarget const valley({"a", "b"}, {{Prior::normal, 0, 3}, {Prior::normal, 0, 3}}, 2, 0,
                          [](std::vector<double> const& w, std::vector<double>& rows) {
                            rows = {1000 * (w[1] - w[0] * w[0]), 0.1 * (1 - w[0])};
                          });
  for (TestTarget const* target : {&needles, &valley}) {
    Shares shares;
    Ledger ledger;
    RunContext context{.seed = 1, .progress = shares, .ledger = ledger};
    search(*target, ObjectiveKind::posterior, context);
    CAPTURE(shares.passes);
    CAPTURE(shares.done);
    CHECK(5 * shares.high < shares.done);
  }
}
