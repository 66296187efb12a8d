// Columns that do not change, as `check` and runs tell of them.
#include "experiment/dead_columns.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <functional>

#include "app/checking.hpp"
#include "app/running.hpp"
#include "core/numeric/elementary.hpp"
#include "report/page/check_page.hpp"

using namespace sysid;

namespace {

struct Row {
  double time, force, level;
};

// A slow drive and a response, with `change` applied to row (from 1).
std::string dead_table(std::function<void(int, Row&)> const& change) {
  std::string text = "t,force,level\n";
  for (int row = 1; row <= 200; ++row) {
    Row all{0.1 * row, 20 * elementary::sin(0.05 * row), 3 * elementary::cos(0.05 * row)};
    change(row, all);
    text += fmt::format("{:.6g},{:.6g},{:.6g}\n", all.time, all.force, all.level);
  }
  return text;
}

std::string const still_text =
    "model m {\n input u [N]\n state y [m]\n initial y = 0.003\n parameter c [1/s] ~ log_uniform(0.1, 10)\n"
    " parameter b [m/(N s)] ~ log_uniform(0.01, 10)\n y' = b*u - c*y\n observe z [m] ~ normal(y, sd = 0.001 [m])\n}\n"
    "data record { file \"record.csv\"; time t [s]; input u = force [mN] hold linear; measure z = level [mm]; split middle = rows "
    "101..190 }\n"
    "posterior = fit m to record.middle with map, seed = 1\n";

CheckResult check_of(std::function<void(int, Row&)> const& change, std::string const& file = still_text) {
  TemporaryFolder folder;
  write_file(folder.path() / "record.csv", dead_table(change));
  return checked(folder.path() / "m.sysid", file);
}

using Messages = std::vector<std::string>;
void nothing(int, Row&) {}

}  // namespace

TEST_CASE("a record that moves is no finding, nor is a zero now and then") {
  CheckResult const sound = check_of([](int row, Row& all) {
    if (row % 3 == 0) all.force = all.level = 0;
  });
  CHECK(messages(sound, "column_constant").empty());
}

TEST_CASE("a channel that is one number in its scored samples is a warning, whatever it does outside of them") {
  CheckResult const dead = check_of([](int row, Row& all) {
    if (row > 100) all.level = 2.5;
  });
  CHECK(messages(dead, "column_constant") ==
        Messages{"z, column `level` of record.middle, is 2.5 mm in all 90 scored samples: was the sensor connected?"});
  CHECK(task(dead, "posterior").findings.front().severity == Severity::warning);
}

TEST_CASE("an input that is constant in its file is a warning, one that is so in the rows alone a note") {
  auto const severity = [](CheckResult const& result) {
    for (Finding const& each : task(result, "posterior").findings)
      if (each.code == FindingCode::column_constant) return each.severity;
    return Severity::error;
  };
  CheckResult const dead = check_of([](int, Row& all) { all.force = 0; });
  CHECK(messages(dead, "column_constant") ==
        Messages{"input u, column `force` of record.middle, is 0 mN in all rows of its file: was the sensor connected?"});
  CHECK(severity(dead) == Severity::warning);
  std::string const rest = with(still_text, "with map", "with map, start = rest");
  CheckResult const over = check_of(
      [](int row, Row& all) {
        if (row > 90) all.force = 0;
      },
      rest);
  REQUIRE(messages(over, "column_constant").size() == 1);
  CHECK(severity(over) == Severity::note);
}

TEST_CASE("a run tells of a dead column before it searches and in its verdict") {
  CaseRun const run(still_text, {{"record.csv", dead_table([](int, Row& all) { all.force = 0; })}});
  CHECK(run.result.notices.find("warning: input u, column `force`") != std::string::npos);
  int found = 0;
  auto const summary = run.summary("posterior");
  for (auto const& each : summary.at("findings")) found += each.at("code") == "column_constant";
  CHECK(found == 1);
}

TEST_CASE("a model that nothing moves is named with what should move it") {
  std::string const at_zero = with(still_text, "initial y = 0.003", "initial y = 0");
  CheckResult const still = check_of([](int, Row& all) { all.force = 0; }, at_zero);
  REQUIRE(messages(still, "prior_at_rest").size() == 1);
  CHECK(messages(still, "prior_at_rest")[0].starts_with("z is constant in the simulation of every prior draw"));
  CHECK(messages(check_of(nothing, at_zero), "prior_at_rest").empty());
  CHECK(messages(check_of(nothing), "prior_at_rest").empty());
}

TEST_CASE("an input that no draw lets through is not said to be missing from the equations") {
  std::string const closed = with(with(still_text, "initial y = 0.003", "initial y = 0"), "b*u", "b*max(u - 1 [kN], 0 [N])");
  auto const help = [](CheckResult const& result) {
    for (Finding const& each : preflight(result, "posterior").findings)
      if (each.code == FindingCode::prior_at_rest) return each.help;
    return std::string();
  };
  CHECK(help(check_of(nothing, closed)).starts_with("an input enters the equations, but does not affect this channel"));
  CHECK(help(check_of(nothing, with(closed, "b*max(u - 1 [kN], 0 [N])", "0*b*u"))) ==
        "check that an equation of this state contains an input");
}

TEST_CASE("a level of which the model says that it is constant may be measured with noise") {
  std::string const constant =
      "model m {\n parameter a [mm] ~ normal(0, sd = 10)\n observe z [mm] ~ normal(a, sd = 1 [mm])\n}\n"
      "data record { file \"record.csv\"; measure z = level [mm] }\nposterior = fit m to record with map, seed = 1\n";
  CHECK(messages(check_of(nothing, constant), "prior_at_rest").empty());
}

TEST_CASE("rows without time have no sampling rate and no band") {
  std::string const rows =
      "model m {\n input u [mN]\n parameter a [mm/mN] ~ normal(0, sd = 10)\n observe z [mm] ~ normal(a*u, sd = 1 [mm])\n}\n"
      "data record { file \"record.csv\"; input u = force [mN]; measure z = level [mm] }\n"
      "posterior = fit m to record with map, seed = 1\n";
  std::string const page = check_text(check_of(nothing, rows).page);
  CHECK(page.find("Hz") == std::string::npos);
  CHECK(page.find("power") == std::string::npos);
  CHECK(check_text(check_of(nothing).page).find("10 Hz") != std::string::npos);
}

TEST_CASE("a part of the split that goes beyond the file is an error even if no task reads it") {
  std::string const beyond = with(still_text, "rows 101..190", "rows 101..190, test = rows 191..400");
  CheckResult const result = check_of(nothing, beyond);
  REQUIRE(result.diagnostics.all().size() == 1);
  CHECK(result.diagnostics.all().front().code == "E4016");
  CHECK(result.diagnostics.all().front().message.starts_with("range `test` selects rows 191..400"));
  CHECK(check_of(nothing, with(still_text, "rows 101..190", "rows 101..190, test = rows 191..200")).diagnostics.all().empty());
}

TEST_CASE("simulations that fail without an input are not blamed on the unit of an input") {
  std::string const grows =
      "model m {\n state y [m]\n initial y = 1\n parameter r [1/s] ~ log_uniform(1, 10)\n y' = r*y\n observe z [m] ~ normal(y, sd "
      "= "
      "0.001 [m])\n}\ndata record { file \"record.csv\"; time t [day]; measure z = level [mm] }\n"
      "posterior = fit m to record with map, seed = 1\n";
  CheckResult const result = check_of(nothing, grows);
  auto const& findings = preflight(result, "posterior").findings;
  auto const failing =
      std::find_if(findings.begin(), findings.end(), [](Finding const& each) { return each.code == FindingCode::prior_fails; });
  REQUIRE(failing != findings.end());
  CHECK(failing->help ==
        "check the named expression (for example for a noise sd of 0), the priors, and the unit of time in the data block");
}
