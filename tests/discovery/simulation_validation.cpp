// Discovered structures judged by simulation: what is refitted, ranked, scored and said, and that it is the same however it is run.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "discovery/coefficients.hpp"
#include "discovery/discovered.hpp"

using namespace sysid;
using namespace sysid::test;
using json = nlohmann::json;

namespace {

struct Judged : Discovered {
  using Discovered::Discovered;

  json const& judged() const { return summary.at("discovery").at("judged"); }
  json const& first() const { return judged().at("structures").at(0); }
  /// Among all findings: the terminal shows five.
  bool found(std::string const& code) const {
    json const& all = summary.at("findings");
    return std::any_of(all.begin(), all.end(), [&](json const& each) { return each.at("code") == code; });
  }
};

}  // namespace

TEST_CASE("Duffing's equation is refitted, ranked first and foretells rows that nothing has seen") {
  Judged const found(duffing);
  json const& judged = found.judged();
  CHECK(judged.at("whole") == true);
  CHECK(judged.at("segments") == 1);
  CHECK(judged.at("kept_aside") == "bench.test");
  CHECK(judged.at("kept_aside_seen_by_choice") == false);
  CHECK(judged.at("structures").size() == 5);
  json const& first = found.first();
  CHECK(first.at("terms") == "y'', y', y, y^3");
  CHECK(first.at("rank_by_regression") == 1);
  CHECK(first.at("probability").get<double>() > 0.95);
  CHECK(first.at("draws_bounded") == first.at("draws"));
  check_coefficients(first, {1, 20, 1e4, 5e9}, 0.015);
  json const& channel = first.at("channels").at(0);
  // Noise of 1 % of the sd of the clean displacement is in what is compared.
  double const sd = channel.at("sd");
  CHECK(channel.at("free_run").get<double>() < 0.015 * sd);
  CHECK(channel.at("free_run").get<double>() > 0.008 * sd);
  CHECK(channel.at("one_step").get<double>() < 0.015 * sd);
  CHECK(channel.at("horizon").get<double>() < 0.015 * sd);
  CHECK(found.result.out.find("verdict: " + first.at("equations").at(0).get<std::string>()) != std::string::npos);
}

TEST_CASE("where differences mislead the regression, simulation ranks the true structure first and it is what is written") {
  Judged const found(with(duffing, "derivatives = weak", "derivatives = central"));
  json const& first = found.first();
  CHECK(first.at("terms") == "y'', y', y, y^3");
  CHECK(first.at("rank_by_regression").get<int>() > 1);
  CHECK(found.found("simulation_prefers"));
  CHECK(std::abs(first.at("coefficients").at(0).at("regression").get<double>() - 1) > 0.3);
  check_coefficients(first, {1, 20, 1e4, 5e9}, 0.015);
  std::string const source = read_file(found.place / "found.sysid");
  CHECK(source.find("x = a1*y'' + a2*y' + a3*y + a5*y^3") != std::string::npos);
}

TEST_CASE("a chaotic record is refitted, and its last fifth foretold from a window") {
  Judged const found(read_file(discovery_models / "lorenz.sysid"));
  CHECK(found.result.exit == 0);
  json const& judged = found.judged();
  CHECK(judged.at("kept_aside") == "the last fifth of record");
  CHECK(judged.at("kept_aside_seen_by_choice") == true);
  json const& first = found.first();
  CHECK(first.at("rank_by_regression") == 1);
  check_coefficients(first, {-10, 10, 28, -1, -1, -8.0 / 3, 1}, 0.005);
  for (json const& channel : first.at("channels")) {
    double const sd = channel.at("sd");
    CHECK(channel.at("residual").get<double>() == doctest::Approx(0.01 * sd).epsilon(0.2).scale(0));
    CHECK(channel.at("horizon").get<double>() < 0.02 * sd);
  }
}

TEST_CASE("an equation that lacks a term is followed in parts, its residual and its forecast say so") {
  Judged const found(with(duffing, "y^2, y^3,", "y^2,"));
  CHECK(found.judged().at("whole") == false);
  CHECK(found.found("motion_unexplained"));
  CHECK(found.found("followed_in_parts"));
  CHECK(found.first().at("residual_over_noise").get<double>() > 3);
  json const& channel = found.first().at("channels").at(0);
  CHECK(channel.at("free_run").get<double>() > 0.2 * channel.at("sd").get<double>());
}

TEST_CASE("a structure that is no model says so, and what is judged is without it") {
  Judged const found(with(duffing, "terms = y'', y', y, y^2, y^3,", "terms = y, y^3,"));
  for (json const& structure : found.judged().at("structures"))
    if (structure.contains("failure")) CHECK_FALSE(structure.at("failure").get<std::string>().empty());
  CHECK(found.result.out.find("structures that could not be checked by simulation") != std::string::npos);
}

TEST_CASE("a judgement is the same bytes for any number of threads and lanes") {
  Judged const one(duffing);
  for (ExecutionOptions const execution : {ExecutionOptions{1, 1}, ExecutionOptions{8, 3}}) {
    RunOptions options;
    options.execution = execution;
    Judged const other(duffing, options);
    for (char const* name : {"summary.json", "structures.csv", "refit.csv", "found.sysid"})
      CHECK(without(read_file(one.place / name), one.folder.path().string()) ==
            without(read_file(other.place / name), other.folder.path().string()));
    CHECK(one.result.out == other.result.out);
  }
}

TEST_CASE("the refit may be left out, and then the regression's word is the last") {
  Judged const found(with(duffing, ", seed = 1", ", refit = no, seed = 1"));
  CHECK_FALSE(found.summary.at("discovery").contains("judged"));
  CHECK_FALSE(std::filesystem::exists(found.place / "structures.csv"));
  std::string const equation = found.summary.at("discovery").at("equations").at(0).at("equation");
  CHECK(found.result.out.find("verdict: " + equation) != std::string::npos);
  CHECK(read_file(found.place / "resolved.sysid").find("refit = no") != std::string::npos);
}

TEST_CASE("an interruption at any point of a judgement leaves nothing half done") {
  for (std::uint64_t poll = 1; poll <= 200; poll += poll < 15 ? 1 : 13) {  // the first refits begin within a few
    CAPTURE(poll);
    TemporaryFolder folder;
    RunOptions options;
    options.output = folder.path() / "results";
    options.interrupt_after = poll;
    RunResult const result = run_text(discovery_models / "here.sysid", duffing, options);
    clear_interrupt();
    CHECK((result.exit == 75 || result.exit == 0));
    CHECK(std::filesystem::exists(options.output / "found/summary.json") == (result.exit == 0));
  }
}
