// A time column against `rate` and `step`, and columns with two uses: `check` says so, and its cures are followed as they stand.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <functional>

#include "app/checking.hpp"
#include "app/running.hpp"

using namespace sysid;

namespace {

using Messages = std::vector<std::string>;

/// A cell of the first column in row i, from 0.
using TimeCell = std::function<std::string(int)>;

std::string const response_rest = "; input u = force [N] hold linear; measure z = level [mm]";

CheckResult check_block(std::string const& name, TimeCell const& cell, std::string const& block) {
  TemporaryFolder folder;
  std::string table = name + ",force,level\n";
  for (int i = 0; i < 200; ++i)
    table += fmt::format("{},{:.6g},{:.6g}\n", cell(i), 20 * std::sin(0.05 * i), 3 * std::cos(0.05 * i));
  write_file(folder.path() / "record.csv", table);
  return checked(folder.path() / "m.sysid",
                 "model m {\n input u [N]\n state y [m]\n initial y = 0.003\n parameter c [1/s] ~ log_uniform(0.1, 10)\n"
                 " parameter b [m/(N s)] ~ log_uniform(0.01, 10)\n y' = b*u - c*y\n observe z [m] ~ normal(y, sd = 0.001 [m])\n}\n"
                 "data record { file \"record.csv\"; " +
                     block + " }\nposterior = fit m to record with map, seed = 1\n");
}
Messages contradictions(std::string const& name, TimeCell const& cell, std::string const& block) {
  return messages(check_block(name, cell, block + response_rest), "rate_contradicted");
}

Finding finding_of(CheckResult const& result, FindingCode code) {
  for (Finding const& each : task(result, "posterior").findings)
    if (each.code == code) return each;
  return {};
}
/// What stands in the backticks of a help, from the n-th on.
std::string line_in(std::string const& help, int n = 0) {
  std::size_t begin = 0, end = 0;
  for (int i = 0; i <= n; ++i) {
    begin = help.find('`', i == 0 ? 0 : end + 1) + 1;
    end = help.find('`', begin);
  }
  return help.substr(begin, end - begin);
}

TimeCell scaled(double step, double first = 0) {
  return [=](int i) { return fmt::format("{:.10g}", first + step * i); };
}

}  // namespace

TEST_CASE("a rate that the time column contradicts is a warning, whose lines end it") {
  CheckResult const wrong = check_block("t", scaled(0.02), "rate 20 [Hz]" + response_rest);
  CHECK(
      messages(wrong, "rate_contradicted") ==
      Messages{"`record` has `rate` 20 Hz, but the time in column `t` of record has steps of 0.02 s (50 Hz): with a wrong time all "
               "rates and frequencies are wrong"});
  Finding const said = finding_of(wrong, FindingCode::rate_contradicted);
  CHECK(said.severity == Severity::warning);
  CHECK(line_in(said.help) == "time t [s]");
  CHECK(line_in(said.help, 2) == "rate 50 [Hz]");
  CHECK(contradictions("t", scaled(0.02), line_in(said.help)).empty());
  CHECK(contradictions("t", scaled(0.02), line_in(said.help, 2)).empty());
  CHECK(contradictions("T", scaled(0.02), "rate 20 [Hz]").size() == 1);
  CHECK(contradictions("Time (ms)", scaled(0.02), "rate 50 [Hz]").size() == 1);  // 50 kHz by its unit
  Finding const step = finding_of(check_block("t_ms", scaled(20), "step 50 [s]" + response_rest), FindingCode::rate_contradicted);
  CHECK(step.message.starts_with("`record` has `step` 50 s, but the time in column `t_ms` of record has steps of 0.02 s (50 Hz)"));
  CHECK(line_in(step.help) == "time t_ms [ms]");
  CHECK(contradictions("t_ms", scaled(20), line_in(step.help)).empty());
}

TEST_CASE("gaps and unequal steps that a rate hides are warnings") {
  TimeCell const gap = [](int i) { return fmt::format("{:.6g}", 0.02 * i + (i >= 120 ? 100 : 0)); };
  CheckResult const hidden = check_block("t", gap, "rate 50 [Hz]" + response_rest);
  REQUIRE(messages(hidden, "rate_contradicted").size() == 1);
  CHECK(messages(hidden, "rate_contradicted")[0].find("has a gap of 100 s between rows 120 and 121") != std::string::npos);
  CHECK(contradictions("t", gap, "time t [s]").empty());
  TimeCell const lost = [](int i) { return fmt::format("{:.6g}", 0.02 * (i + (i >= 50 ? 1 : 0))); };  // one sample
  CHECK(contradictions("t", lost, "rate 50 [Hz]").size() == 1);
  TimeCell const uneven = [](int i) { return fmt::format("{:.6g}", 0.02 * i + 0.008 * std::sin(1.7 * i)); };
  Messages const said = contradictions("t", uneven, "rate 50 [Hz]");
  REQUIRE(said.size() == 1);
  CHECK(said[0].find("unequal steps") != std::string::npos);
}

TEST_CASE("a rate that the column agrees with is no finding: by its unit, by rounding, by dates") {
  CHECK(contradictions("t", scaled(0.02), "rate 50 [Hz]").empty());
  CHECK(contradictions("t", scaled(0.02, 7.3), "step 0.02 [s]").empty());
  CHECK(contradictions("t [ms]", scaled(20), "rate 50 [Hz]").empty());
  CHECK(contradictions("Zeit_ms", scaled(20), "rate 50 [Hz]").empty());
  CHECK(contradictions("t", scaled(20), "rate 50 [Hz]").empty());     // whole milliseconds without a unit
  CHECK(contradictions("t", scaled(20000), "rate 50 [Hz]").empty());  // microseconds
  CHECK(contradictions("t", scaled(1), "rate 1 [1/year]").empty());
  CHECK(contradictions("t", scaled(2), "step 2 [week]").empty());
  TimeCell const rounded = [](int i) { return fmt::format("{}", std::round(i * 1000 / 256.0)); };
  CHECK(contradictions("t_ms", rounded, "rate 256 [Hz]").empty());
  TimeCell const coarse = [](int i) { return fmt::format("{:.3f}", i / 800.0 + 1e-9); };
  CHECK(contradictions("t", coarse, "rate 800 [Hz]").empty());
  // The clock of the logger is off by 0.03 %, and its stamps by a twentieth of a step.
  TimeCell const clock = [](int i) { return fmt::format("{:.9g}", 0.020006 * i + 0.001 * std::sin(2.3 * i)); };
  CHECK(contradictions("t", clock, "rate 50 [Hz]").empty());
  TimeCell const stamp = [](int i) { return fmt::format("2024-05-01 12:{:02}:{:02}", i / 60, i % 60); };
  CHECK(contradictions("Date", stamp, "rate 1 [Hz]").empty());
  CHECK(contradictions(
            "Date", [](int i) { return fmt::format("{:.9f}", 45000.5 + i / 86400.0); }, "rate 1 [Hz]")
            .empty());
}

TEST_CASE("dates that contradict the rate are read by the lines of the help") {
  TimeCell const stamp = [](int i) { return fmt::format("2024-05-01 12:{:02}:{:02}", i / 60, i % 60); };
  CheckResult const wrong = check_block("Date", stamp, "rate 10 [Hz]" + response_rest);
  REQUIRE(messages(wrong, "rate_contradicted").size() == 1);
  std::string const help = finding_of(wrong, FindingCode::rate_contradicted).help;
  CHECK(line_in(help).starts_with("read stamp = "));
  CHECK(line_in(help, 1) == "time Date");
  CHECK(contradictions("Date", stamp, line_in(help) + "; " + line_in(help, 1)).empty());
}

TEST_CASE("columns that are no time say nothing of a rate, and those that may be one are a note") {
  CHECK(contradictions(
            "x", [](int i) { return fmt::format("{:.6g}", 3 * std::sin(0.3 * i)); }, "rate 20 [Hz]")
            .empty());
  CHECK(contradictions(
            "t", [](int i) { return fmt::format("{:.6g}", 3 * std::sin(0.3 * i)); }, "rate 20 [Hz]")
            .empty());
  CHECK(contradictions("sample", scaled(1), "rate 20 [Hz]").empty());
  CHECK(contradictions("t [mm]", scaled(0.02), "rate 20 [Hz]").empty());
  TimeCell const warming = [](int i) { return fmt::format("{:.6g}", 20 + 5 * (1 - std::exp(-0.01 * i))); };
  CHECK(contradictions("T", warming, "rate 20 [Hz]").empty());
  CheckResult const unnamed = check_block("x", scaled(0.02), "rate 20 [Hz]" + response_rest);
  CHECK(finding_of(unnamed, FindingCode::rate_contradicted).severity == Severity::note);
  CHECK(line_in(finding_of(unnamed, FindingCode::rate_contradicted).help) == "time x [s]");
  CHECK(contradictions("x", scaled(0.02), "rate 50 [Hz]").empty());
  // 0.05 for 20 kHz: milliseconds, or a rate in kHz that is in Hz.
  CheckResult const doubtful = check_block("t", scaled(0.05), "rate 20 [kHz]" + response_rest);
  CHECK(finding_of(doubtful, FindingCode::rate_contradicted).severity == Severity::note);
  CHECK(line_in(finding_of(doubtful, FindingCode::rate_contradicted).help) == "time t [ms]");
  CHECK(contradictions("t", scaled(0.05), "time t [ms]").empty());
}

TEST_CASE("a channel whose column is the input or the time is a warning, the column of its sensor is none") {
  auto const twice = [](std::string const& block) { return messages(check_block("t", scaled(0.02), block), "column_used_twice"); };
  Messages const input = twice("time t [s]; input u = force [N] hold linear; measure z = force [mm]");
  CHECK(input == Messages{"z is read from column `force` of record, which is also the input u: the channel has no measurement of its own"});
  CheckResult const shown = check_block("t", scaled(0.02), "time t [s]; input u = force [N] hold linear; measure z = force [mm]");
  std::string const help = finding_of(shown, FindingCode::column_used_twice).help;
  CHECK(help == "write the column of its sensor in `measure z = ...`; columns that are not used: `level`");
  CHECK(twice("time t [s]; input u = force [N] hold linear; measure z = level [mm]").empty());
  CHECK(twice("time t [s]; input u = force [N] hold linear; measure z = t [mm]").size() == 1);
  CHECK(twice("rate 50 [Hz]; input u = force [N] hold linear; measure z = t [mm]").size() == 1);
}
