// The tolerance guard on targets whose optimum depends on the solver in a known way.
#include "diagnostics/tolerance/tolerance_check.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "app/running.hpp"
#include "app/search/solver_refinement.hpp"
#include "core/numeric/random.hpp"
#include "inference/targets.hpp"
#include "relative.hpp"
#include "search/global/search.hpp"
#include "search/journal.hpp"
#include "search/mode/at_bound.hpp"
#include "search/mode/moves.hpp"
#include "search/refit.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

/// N(x | centre, 0.1^2) under a wide prior, with as many residual rows as a long record has.
std::unique_ptr<Target> centred(double centre, int rows = 1) {
  return std::make_unique<TestTarget>(std::vector<std::string>{"x"}, std::vector<Prior>{{Prior::normal, 0, 10}}, rows, 0,
                                      [=](std::vector<double> const& w, std::vector<double>& out) {
                                        std::fill(out.begin(), out.end(), 0.0);
                                        out[0] = (w[0] - centre) / 0.1;
                                      });
}

RefinedSolver settled(std::function<double(int substeps)> const& centre, int rows) {
  Bench bench;
  SolverSettings const from;
  std::vector<Mode> modes = search(*centred(centre(from.substeps)), ObjectiveKind::posterior, bench.context).modes;
  MakeTarget const make = [&](SolverSettings const& solver) { return centred(centre(solver.substeps), rows); };
  return find_converged_solver(make, ObjectiveKind::posterior, from, std::move(modes), bench.context);
}

/// a and b, known to 0.1 each, with a correlation; the finer solver moves the optimum by so many sds.
std::unique_ptr<Target> pair(double a, double b, double correlation = 0) {
  double const other = std::sqrt(1 - correlation * correlation);
  return std::make_unique<TestTarget>(std::vector<std::string>{"a", "b"}, std::vector<Prior>(2, {Prior::normal, 0, 10}), 2, 0,
                                      [=](std::vector<double> const& w, std::vector<double>& out) {
                                        out[0] = w[0] / 0.1 - a;
                                        out[1] = (w[1] / 0.1 - b - correlation * out[0]) / other;
                                      });
}

/// Draws of `pair(0, 0, correlation)`.
Draws draws_of_pair(std::uint64_t seed, int count, double correlation = 0) {
  Draws draws;
  draws.names = {"a", "b"};
  draws.units = {"", ""};
  draws.parameter_count = 2;
  double const other = std::sqrt(1 - correlation * correlation);
  for (int c = 0; c < 4; ++c) {
    Stream stream({seed, Purpose::test, static_cast<std::uint64_t>(c), 0});
    Chain chain;
    for (int d = 0; d < count / 4; ++d) {
      double const first = stream.normal(), second = correlation * first + other * stream.normal();
      chain.values.push_back({0.1 * first, 0.1 * second});
    }
    draws.chains.push_back(std::move(chain));
  }
  return draws;
}

SolverCheck check_of_pair(std::uint64_t seed, double a, double b, double correlation = 0) {
  Bench bench;
  auto const coarse = pair(0, 0, correlation), fine = pair(a, b, correlation);
  std::vector<Mode> const modes = search(*coarse, ObjectiveKind::posterior, bench.context).modes;
  return check_draws(*coarse, *fine, draws_of_pair(seed, 8000, correlation), modes, seed, bench.ledger);
}

constexpr int short_record = 10, long_record = 200'000;

}  // namespace

TEST_CASE("a solver is refined until halving its step moves nothing any more, however long that takes") {
  for (int const rows : {short_record, long_record}) {
    // 3 sd between one step and two, a quarter of it each time: 0.19 sd, then 0.05.
    RefinedSolver const found = settled([](int substeps) { return 0.4 / std::pow(substeps, 2); }, rows);
    CHECK(found.converged);
    CHECK(found.solver.substeps == 8);
  }
}

TEST_CASE("a result that moves at every halving is tried to the finest, unless that takes long") {
  auto const restless = [](int substeps) { return static_cast<int>(std::log2(substeps)) % 2 == 0 ? 0.0 : 0.3; };
  RefinedSolver const quick = settled(restless, short_record), slow = settled(restless, long_record);
  CHECK(!quick.converged);
  CHECK(!quick.given_up);
  CHECK(quick.solver.substeps == 256);
  CHECK(!slow.converged);
  CHECK(slow.given_up);
  CHECK(slow.solver.substeps < 64);
}

TEST_CASE("weighted draws tell a mean's move with an error that covers it") {
  Bench bench;
  auto const coarse = pair(0, 0), fine = pair(0.3, 0);
  double squares = 0;
  constexpr int records = 200;
  for (std::uint64_t seed = 1; seed <= records; ++seed) {
    Reweighting const weighted = reweigh(*coarse, *fine, draws_of_pair(seed, 8000), 200, bench.ledger);
    REQUIRE(weighted.usable());
    double const z = (weighted.move[0] - 0.3) / weighted.error[0];
    squares += z * z;
    CHECK(std::abs(z) < 4.5);
    CHECK(weighted.move[1] < 4.5 * weighted.error[1]);
  }
  // chi-squared of `records` degrees of freedom, an sd of 10 %; 200 draws make the error itself uncertain.
  CHECK(squares / records == doctest::Approx(1).epsilon(0.35));
}

TEST_CASE("a move along a narrow direction is none of the parameters, whatever 200 draws suggest") {
  // a + b is known ten times better than either: it moves by 0.7 of its sd, a and b by 0.05 of theirs.
  constexpr double correlation = -0.99;
  double const along = 0.7 * std::sqrt((1 + correlation) / 2);
  Bench bench;
  auto const coarse = pair(0, 0, correlation), fine = pair(along, along, correlation);
  int suggested = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Reweighting const weighted = reweigh(*coarse, *fine, draws_of_pair(seed, 8000, correlation), 200, bench.ledger);
    suggested += std::max(weighted.move[0], weighted.move[1]) > tolerable_move ? 1 : 0;
    CHECK(check_of_pair(seed, along, along, correlation).holds());
  }
  CHECK(suggested > 0);  // the move alone, without its error, would have been stated
}

TEST_CASE("the parameter that moves is named with its size, by weights or by its mode") {
  for (double const move : {0.25, 1.0, 8.0}) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      SolverCheck const check = check_of_pair(seed, 0.01, move);
      CHECK(check.outcome == (move < 5 ? SolverCheck::Outcome::mean_moves : SolverCheck::Outcome::mode_moves));
      REQUIRE(check.moved.size() == 1);
      CHECK(check.moved.front().parameter == "b");
      CHECK(check.largest() == relative(move, 0.2));
      Findings const findings = tolerance_findings(check, {}, false);
      REQUIRE(findings.size() == 1);
      CHECK(findings.front().names == std::vector<std::string>{"b"});
      CHECK(findings.front().severity == Severity::error);
    }
  }
  CHECK(tolerance_findings(check_of_pair(1, 0.01, 0.02), {}, false).empty());
}

TEST_CASE("a finer solver that fails at many draws is said to fail") {
  Bench bench;
  auto const coarse = centred(0);
  auto const fine = std::make_unique<TestTarget>(
      std::vector<std::string>{"x"}, std::vector<Prior>{{Prior::normal, 0, 10}}, 1, 0,
      [](std::vector<double> const& w, std::vector<double>& out) { out[0] = w[0] > 0 ? std::nan("") : w[0] / 0.1; });
  Draws draws = draws_of_pair(1, 400);
  draws.names = {"x"};
  draws.parameter_count = 1;
  SolverCheck const check = check_draws(*coarse, *fine, draws, {}, 1, bench.ledger);
  CHECK(check.outcome == SolverCheck::Outcome::fails);
  CHECK(check.failed == doctest::Approx(0.5).epsilon(0.2));
  SolverSettings const budget{.method = "dopri5", .steps = 1};
  CHECK(tolerance_findings(check, budget, false).front().help.find("more `steps` (now 1)") != std::string::npos);
}

TEST_CASE("an optimum at a bound has no sd to compare with; one inside has") {
  // The likelihood is highest at 1.5 and 2 sds further, beyond the bound or within it.
  auto const bounded = [](double upper, double centre) {
    return std::make_unique<TestTarget>(
        std::vector<std::string>{"x"}, std::vector<Prior>{{Prior::uniform, 0, upper}}, 1, 0,
        [=](std::vector<double> const& w, std::vector<double>& out) { out[0] = (w[0] - centre) / 0.1; });
  };
  for (double const upper : {1.0, 5.0}) {
    Bench bench;
    std::vector<Mode> const modes = search(*bounded(upper, 1.5), ObjectiveKind::declared_posterior, bench.context).modes;
    CHECK(at_bound(bounded(upper, 1.5)->parameters()[0], modes.front().declared[0], modes.front().sd[0]) == (upper == 1));
    SolverCheck const check = check_modes(*bounded(upper, 1.7), ObjectiveKind::declared_posterior, modes, 1, bench.ledger);
    CHECK(check.holds() == (upper == 1));
    if (upper > 1) CHECK(check.outcome == SolverCheck::Outcome::mode_moves);
  }
}

TEST_CASE("a curvature that is wrong makes no move where nothing is gained by it") {
  Bench bench;
  std::vector<Mode> modes = search(*centred(0), ObjectiveKind::posterior, bench.context).modes;
  modes.front().sd[0] /= 400;  // as rough steps may leave it: 0.008 sd look like 3.2
  std::vector<double> gains;
  auto const fine = centred(0.0008);
  std::vector<Mode> const refined = refit(*fine, ObjectiveKind::posterior, modes, 1, bench.ledger, {}, &gains);
  sysid::Move const ill = largest_move(fine->parameters(), modes[0], refined[0], gains[0]);
  CHECK(ill.size() == relative(0.008, 1e-3));
  modes.front().sd[0] *= 400;
  SolverCheck const moved = check_modes(*centred(0.32), ObjectiveKind::posterior, modes, 1, bench.ledger);
  CHECK(moved.outcome == SolverCheck::Outcome::mode_moves);
  CHECK(moved.largest() == doctest::Approx(3.2).epsilon(0.01));
}

TEST_CASE("an optimum that stays with another curvature is said as that") {
  auto const wide = [](double sd) {
    return std::make_unique<TestTarget>(std::vector<std::string>{"x"}, std::vector<Prior>{{Prior::normal, 0, 10}}, 1, 0,
                                        [=](std::vector<double> const& w, std::vector<double>& out) { out[0] = w[0] / sd; });
  };
  Bench bench;
  std::vector<Mode> const modes = search(*wide(0.1), ObjectiveKind::likelihood, bench.context).modes;
  SolverCheck const check = check_modes(*wide(0.2), ObjectiveKind::likelihood, modes, 1, bench.ledger);
  CHECK(check.outcome == SolverCheck::Outcome::width_moves);
  CHECK(tolerance_findings(check, {}, false).front().message.find("the sd of x is 0.2 in place of 0.1") != std::string::npos);
  CHECK(check_modes(*wide(0.101), ObjectiveKind::likelihood, modes, 1, bench.ledger).holds());
}

TEST_CASE("a curvature that no step settles leaves the choice to the values") {
  auto const made = [](SolverSettings const& solver) {
    bool const odd = static_cast<int>(std::log2(solver.substeps)) % 2 == 1;
    double const sd = odd ? 0.13 : 0.1, centre = 0.4 / std::pow(solver.substeps, 2);
    return std::make_unique<TestTarget>(std::vector<std::string>{"x"}, std::vector<Prior>{{Prior::normal, 0, 10}}, short_record, 0,
                                        [=](std::vector<double> const& w, std::vector<double>& out) {
                                          std::fill(out.begin(), out.end(), 0.0);
                                          out[0] = (w[0] - centre) / sd;
                                        });
  };
  Bench bench;
  std::vector<Mode> modes = search(*made({}), ObjectiveKind::posterior, bench.context).modes;
  RefinedSolver const found = find_converged_solver(made, ObjectiveKind::posterior, {}, std::move(modes), bench.context);
  CHECK_FALSE(found.converged);
  CHECK(found.widths_alone);
  CHECK(found.solver.substeps == 8);
}

TEST_CASE("the solver that a finding advises is fine enough for the move that it states") {
  CHECK(fine_enough({.substeps = 1}, 0.2).substeps == 2);  // order 4: 0.0125 sd then
  CHECK(fine_enough({.substeps = 1}, 10).substeps == 4);   // 0.6, then 0.04
  CHECK(fine_enough({.method = "euler", .substeps = 1}, 0.8).substeps == 16);
  SolverSettings const loose{.method = "dopri5", .relative = 1e-4};
  CHECK(fine_enough(loose, 0.2).relative == 1e-6);
  // None is advised that the language refuses.
  CHECK(fine_enough({.method = "euler", .substeps = 1}, 1e9).within_limits());
  SolverSettings const finest{.method = "dopri5", .relative = 1e-13};
  SolverCheck moves;
  moves.outcome = SolverCheck::Outcome::mode_moves;
  moves.moved = {{"x", "", 3, 0, 0, 0}};
  CHECK(tolerance_findings(moves, finest, false).front().help.find("cannot be made finer: fit with `solver = cvode`") !=
        std::string::npos);
}

TEST_CASE("a method of low order that would need very many steps is advised another") {
  SolverCheck moves;
  moves.outcome = SolverCheck::Outcome::mode_moves;
  moves.moved = {{"x", "", 73, 0, 0, 0}};
  auto const help = [&](SolverSettings const& solver) { return tolerance_findings(moves, solver, false).front().help; };
  CHECK(help({.method = "euler", .substeps = 1}).find("fit with `solver = rk4`") == 0);
  CHECK(help({.substeps = 1}).find("fit again with `substeps = 8`") == 0);
}

TEST_CASE("a solver that is part of the model is reported, not failed") {
  SolverCheck const check = check_of_pair(1, 0, 1);
  Findings const declared = tolerance_findings(check, {.substeps = 1, .as_model = true}, false);
  REQUIRE(declared.size() == 1);
  CHECK(declared.front().severity == Severity::note);
  CHECK(declared.front().message.find("the mean of b would move by ") != std::string::npos);
  CHECK(tolerance_findings(check, {.substeps = 1}, false).front().severity == Severity::error);
}

TEST_CASE("a stiff part of the prior is named where an implicit solver follows what explicit steps lose") {
  // Explicit steps follow x < 0, an implicit solver everything or the same half.
  auto const search_of = [](bool stiff) {
    return search_solver(
        [=](SolverSettings const& solver) {
          bool const all = stiff && solver.row().stiff;
          return std::make_unique<TestTarget>(
              std::vector<std::string>{"x"}, std::vector<Prior>{{Prior::normal, 0, 10}}, 1, 0,
              [=](std::vector<double> const& w, std::vector<double>& out) { out[0] = all || w[0] < 0 ? w[0] : std::nan(""); });
        },
        SolverSettings{}, 1);
  };
  CHECK(search_of(true).stiff());
  CHECK(search_of(true).failed == doctest::Approx(0.5).epsilon(0.2));
  CHECK_FALSE(search_of(false).stiff());
}

TEST_CASE("a prior that is too fast for the shortest steps is named where shorter ones have followed more each time") {
  // Explicit steps follow x < first + more*log4(substeps), no implicit solver anything else.
  auto const search_of = [](double first, double more) {
    return search_solver(
        [=](SolverSettings const& solver) {
          double const most = first + more * std::log2(std::max(1, solver.substeps)) / 2;
          return std::make_unique<TestTarget>(
              std::vector<std::string>{"x"}, std::vector<Prior>{{Prior::normal, 0, 10}}, 1, 0,
              [=](std::vector<double> const& w, std::vector<double>& out) { out[0] = w[0] < most ? w[0] : std::nan(""); });
        },
        SolverSettings{}, 1);
  };
  CHECK(search_of(-10, 4).too_fast());
  CHECK_FALSE(search_of(-10, 0).too_fast());   // what diverges does so with any steps
  CHECK_FALSE(search_of(-10, 25).too_fast());  // the second are short enough for most
  CHECK(stiff_prior(search_of(-10, 4)).size() == 1);
  CHECK(stiff_prior(search_of(-10, 25)).empty());
}

TEST_CASE("the trials of solvers for a search go on where they were interrupted") {
  // Every step fails at two draws in three, an implicit solver follows: all trials are made. From the call on that is named, in its
  // middle, all is worthless.
  struct Tried {
    SearchSolver found;
    int calls = 0;
    nlohmann::json kept;
  };
  auto const tried = [](int last, nlohmann::json const& stored) {
    Tried result;
    Journal journal([&](nlohmann::json const& steps) { result.kept = steps; }, 0, stored.is_null() ? nullptr : &stored);
    struct Counting : TestTarget {
      Counting(bool stiff, int last, int& calls)
          : TestTarget(
                {"x"}, {{Prior::normal, 0, 10}}, 1, 0,
                [=](std::vector<double> const& w, std::vector<double>& out) { out[0] = stiff || w[0] < -4 ? w[0] : std::nan(""); }),
            last_(last),
            calls_(calls) {}
      void log_likelihood(ConstLanes theta, std::span<double> out, Ledger& ledger) const override {
        TestTarget::log_likelihood(theta, out, ledger);
        if (++calls_ >= last_)
          for (double& value : out) value = -infinity;
      }
      int last_;
      int& calls_;
    };
    result.found = search_solver(
        [&](SolverSettings const& solver) { return std::make_unique<Counting>(solver.row().stiff, last, result.calls); },
        SolverSettings{}, 1, [&] { return result.calls >= last; }, &journal);
    journal.save();
    return result;
  };
  constexpr int never = std::numeric_limits<int>::max();
  Tried const whole = tried(never, nullptr);
  REQUIRE(whole.calls > 4);
  REQUIRE(whole.found.stiff());
  for (int call = 1; call <= whole.calls; ++call) {
    CAPTURE(call);
    Tried const first = tried(call, nullptr), rest = tried(never, first.kept);
    CHECK(rest.calls + first.calls - 1 == whole.calls);
    CHECK(rest.found.solver == whole.found.solver);
    CHECK(rest.found.failed == whole.found.failed);
    CHECK(rest.found.failed_as_given == whole.found.failed_as_given);
    CHECK(rest.found.tried == whole.found.tried);
    CHECK(rest.found.followed == whole.found.followed);
  }
}

TEST_CASE("a motion that ends between two samples is not tied to the step that follows it worst") {
  // With two steps per sample RK4 leaves 7 % of what is gone, at one rate alone; any large rate fits with finer ones.
  for (std::uint64_t record = 1; record <= 8; ++record) {
    CAPTURE(record);
    Stream stream({record, Purpose::test, 0, 0});
    TemporaryFolder folder;
    std::string table = "t,p,q\n";
    for (int i = 0; i < 25; ++i)
      table += fmt::format("{:.3f},{:.6f},{:.6f}\n", 0.134 * i, (i == 0 ? 1 : 0) + 0.01 * stream.normal(),
                           (i == 0 ? 0 : 0.45) + 0.01 * stream.normal());
    write_file(folder.path() / "record.csv", table);
    RunOptions options;
    options.output = folder.path() / "results";
    run_text(folder.path() / "split.sysid",
             "model split {\n state a [-], c [-]\n initial a = 1, c = 0\n parameter k1 [1/s] ~ log_uniform(1e-3, 1e3)\n"
             " parameter k2 [1/s] ~ log_uniform(1e-3, 1e3)\n parameter sigma [-] ~ log_uniform(1e-5, 1)\n a' = -(k1 + k2)*a\n"
             " c' = k2*a\n observe p ~ normal(a, sd = sigma)\n observe q ~ normal(c, sd = sigma)\n}\n"
             "data record { file \"record.csv\"; time t [s]; measure p = p [-]; measure q = q [-] }\n"
             "best = fit split to record with ml, solver = rk4, seed = 1\n",
             options);
    auto const summary = nlohmann::json::parse(read_file(options.output / "best/summary.json"));
    CHECK(summary.at("settings").at("substeps") >= 4);
    CHECK(summary.at("parameters").at("sigma").at("mean") < 0.013);
  }
}
