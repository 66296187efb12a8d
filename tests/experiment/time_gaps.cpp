// Gaps in the time, as `check` tells of them, and what its help makes of them when it is followed word for word.
#include "experiment/time_gaps.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <functional>
#include <regex>

#include "app/checking.hpp"
#include "app/running.hpp"
#include "core/numeric/elementary.hpp"

using namespace sysid;

namespace {

std::string const gap_text =
    "model m {\n input u [N]\n state y [m]\n initial y = 0.003\n parameter c [1/s] ~ log_uniform(0.1, 10)\n"
    " parameter b [m/(N s)] ~ log_uniform(0.01, 10)\n y' = b*u - c*y\n observe z [m] ~ normal(y, sd = 0.001 [m])\n}\n"
    "data record { file \"record.csv\"; time t [s]; input u = force [mN] hold linear; measure z = level [mm] }\n"
    "posterior = fit m to record with map, seed = 1\n";

// Equal steps of 0.1 s, with `later(row)` seconds added (row from 1).
CheckResult check_gap(std::string const& text, std::function<double(int)> const& later) {
  std::string table = "t,force,level\n";
  for (int row = 1; row <= 200; ++row)
    table += fmt::format("{:.6g},{:.6g},{:.6g}\n", 0.1 * row + later(row), 20 * elementary::sin(0.05 * row),
                         3 * elementary::cos(0.05 * row));
  TemporaryFolder folder;
  write_file(folder.path() / "record.csv", table);
  return checked(folder.path() / "m.sysid", text);
}

double one_gap(int row) { return row > 150 ? 10 : 0; }

std::string gap_help(CheckResult const& result) {
  for (Finding const& each : task(result, "posterior").findings)
    if (each.code == FindingCode::time_gap) return each.help;
  return {};
}

// What stands between backticks, in order.
std::vector<std::string> quoted_parts(std::string const& help) {
  std::vector<std::string> parts;
  std::regex const quoted("`([^`]*)`");
  for (std::sregex_iterator i(help.begin(), help.end(), quoted), end; i != end; ++i) parts.push_back((*i)[1]);
  return parts;
}

}  // namespace

TEST_CASE("rows that follow each other at one step, or at steps that vary, have no gap") {
  CHECK(messages(check_gap(gap_text, [](int) { return 0; }), "time_gap").empty());
  CHECK(messages(check_gap(gap_text, [](int row) { return 0.001 * row * row; }), "time_gap").empty());
  CHECK(messages(check_gap(gap_text, [](int row) { return row > 150 ? 0.5 : 0; }), "time_gap").empty());
}

TEST_CASE("ten seconds in which nothing was recorded are named by their rows") {
  using Messages = std::vector<std::string>;
  CHECK(messages(check_gap(gap_text, one_gap), "time_gap") ==
        Messages{"the time of record has a gap of 10.1 s between rows 150 and 151; the usual step is 0.1 s"});
  auto const two = messages(check_gap(gap_text, [](int row) { return row > 110 ? (row > 150 ? 10 : 5) : 0; }), "time_gap");
  REQUIRE(two.size() == 1);
  CHECK(two[0].find("(and 1 more)") != std::string::npos);
}

TEST_CASE("the ranges and the start that the help gives leave the gaps out") {
  auto const followed = [](std::function<double(int)> const& later) {
    std::vector<std::string> const parts = quoted_parts(gap_help(check_gap(gap_text, later)));
    REQUIRE(parts.size() >= 4);  // the split, its block, the ranges to fit to, the start
    REQUIRE(parts[0].starts_with("split "));
    REQUIRE(parts[3].starts_with("start = estimated(rows = "));
    std::string text = with(gap_text, "measure z = level [mm]", "measure z = level [mm]; " + parts[0]);
    text = with(text, "to record with map", "to " + parts[2] + " with map");
    // Without the start it would still go through the gap.
    CHECK_FALSE(messages(check_gap(text, later), "time_gap").empty());
    return messages(check_gap(with(text, "with map", "with map, " + parts[3]), later), "time_gap");
  };
  CHECK(followed(one_gap).empty());
  CHECK(followed([](int row) { return row > 110 ? (row > 150 ? 10 : 5) : 0; }).empty());
}

TEST_CASE("a range that has the gap in it is replaced, one that begins after it needs its start alone") {
  std::string const parted = with(with(gap_text, "[mm] }", "[mm]; split a = rows 101..200 }"), "to record", "to record.a");
  std::vector<std::string> const parts = quoted_parts(gap_help(check_gap(parted, one_gap)));
  REQUIRE(parts.size() >= 5);
  CHECK(parts[1] == "a_1 = rows 101..150, a_2 = rows 151..200");
  std::string const replaced = with(with(parted, "a = rows 101..200", parts[1]), "to record.a", "to " + parts[3]);
  CHECK(messages(check_gap(with(replaced, "with map", "with map, " + parts[4]), one_gap), "time_gap").empty());

  std::string const whole = with(parted, "to record.a", "to record");
  std::vector<std::string> const anew = quoted_parts(gap_help(check_gap(whole, one_gap)));
  REQUIRE(anew.size() >= 5);
  CHECK(anew[0] == "split part_1 = rows 1..150, part_2 = rows 151..200");
  std::string const split_anew = with(with(whole, "split a = rows 101..200", anew[0]), "to record", "to " + anew[3]);
  CHECK(messages(check_gap(with(split_anew, "with map", "with map, " + anew[4]), one_gap), "time_gap").empty());

  std::string const late = with(parted, "a = rows 101..200", "a = rows 160..200");
  std::vector<std::string> const start = quoted_parts(gap_help(check_gap(late, one_gap)));
  REQUIRE(start.size() >= 2);
  CHECK(start[0] == "record.a");
  CHECK(messages(check_gap(with(late, "with map", "with map, " + start[1]), one_gap), "time_gap").empty());
}

TEST_CASE("initial values that are parameters become those of each range") {
  std::string const free = with(gap_text, "initial y = 0.003", "initial y = y0\n parameter y0 [m] ~ normal(0, sd = 0.01)");
  std::string const help = gap_help(check_gap(free, one_gap));
  std::vector<std::string> const parts = quoted_parts(help);
  REQUIRE(parts.size() >= 5);
  CHECK(parts[3] == "start = rest");
  CHECK(parts[4] == "parameter y0 per experiment");
  std::string text = with(free, "[mm] }", "[mm]; " + parts[0] + " }");
  text = with(text, "to record with map", "to " + parts[2] + " with map, " + parts[3]);
  CheckResult const cured = check_gap(with(text, "parameter y0", parts[4]), one_gap);
  CHECK(messages(cured, "time_gap").empty());
  CHECK(messages(cured, "not_identifiable").empty());
}

TEST_CASE("an initial value that the equations read, too, is that of the first range alone: the others' is estimated") {
  // As the temperature around a body that begins as warm: another one for each range would change the equation as well.
  std::string const read = with(gap_text, "initial y = 0.003", "initial y = y0\n parameter y0 [m] ~ normal(0, sd = 0.01)");
  std::string const rest = with(read, "c*y\n", "c*(y - y0)\n");
  std::string const help = gap_help(check_gap(rest, one_gap));
  CHECK(help.find("start = estimated(rows = ") != std::string::npos);
  CHECK(help.find("per experiment") == std::string::npos);
  CHECK(help.find("`y0` a value") == std::string::npos);
}
