// Numbers written where a sensor gave none, in inputs and in what is measured: `check` names their rows, and so does a fit. Those
// that loggers are known to write are asked about before (E4022), unless the data block says that none of them is a mark.
#include "experiment/placeholders.hpp"

#include <doctest/doctest.h>

#include <fmt/format.h>

#include "app/checking.hpp"
#include "app/running.hpp"
#include "core/numeric/elementary.hpp"

using namespace sysid;

namespace {

constexpr int count = 200;

// A slow drive and a response, with `change` applied to row (from 1), force [mN] and level [mm].
template <class Change>
std::string table(Change const& change) {
  std::string text = "t,force,level\n";
  for (int row = 1; row <= count; ++row) {
    double force = 20 * elementary::sin(0.05 * row), level = 3 * elementary::cos(0.05 * row);
    change(row, force, level);
    text += fmt::format("{},{:.3f},{:.3f}\n", 0.1 * row, force, level);
  }
  return text;
}

std::string const text =
    "model m {\n input u [N]\n state y [m]\n initial y = 0\n parameter c [1/s] ~ log_uniform(0.1, 10)\n"
    " parameter b [m/(N s)] ~ log_uniform(0.01, 10)\n y' = b*u - c*y\n observe z [m] ~ normal(y, sd = 0.001 [m])\n}\n"
    "data record { file \"record.csv\"; read missing = \"NaN\"; time t [s]; input u = force [mN] hold linear; measure z = level "
    "[mm]; "
    "split middle = rows "
    "101..190 }\n"
    "posterior = fit m to record.middle with map, seed = 1\n";

template <class Change>
std::vector<std::string> told(Change const& change, std::string const& file = text) {
  TemporaryFolder folder;
  write_file(folder.path() / "record.csv", table(change));
  return messages(checked(folder.path() / "m.sysid", file), "looks_missing");
}

std::string replaced(std::string all, std::string const& from, std::string const& to) {
  return all.replace(all.find(from), from.size(), to);
}

}  // namespace

TEST_CASE("a 9999 in an input and in a channel is named as it stands in the file, as is the end of a converter's range") {
  auto const input = told([](int row, double& force, double&) {
    if (row == 150) force = 9999;
  });
  REQUIRE(input.size() == 1);
  CHECK(input[0] ==
        "column `force` of record is 9999 mN in row 150, far from all its other numbers: this may mark a missing value");
  auto const channel = told([](int row, double&, double& level) {
    if (row > 180) level = -999;
  });
  REQUIRE(channel.size() == 1);
  CHECK(channel[0] ==
        "column `level` of record is -999 mm in rows 181, 182, 183, 184, 185 and 5 more, far from all its other numbers: this may "
        "mark a missing value");
  CHECK(told([](int row, double& force, double& level) {
          if (row == 120) force = -32768, level = 65535;
        }).size() == 2);
}

TEST_CASE("a mark in a column with a unit is named as it stands in the file where the channel has no unit") {
  std::string bare = replaced(replaced(replaced(text, "u [N]", "u"), "y [m]", "y"), "b [m/(N s)]", "b [1/s]");
  bare = replaced(replaced(bare, "z [m]", "z"), "sd = 0.001 [m]", "sd = 0.001");
  auto const found = told(
      [](int row, double&, double& level) {
        if (row > 180) level = -999;
      },
      bare);
  REQUIRE(found.size() == 1);
  CHECK(found[0].starts_with("column `level` of record is -999 mm in rows 181, "));
}

TEST_CASE("`missing = none`, alone or behind words, says that no number is a mark") {
  auto const change = [](int row, double& force, double&) {
    if (row == 150) force = 9999;
  };
  CHECK(told(change).size() == 1);
  CHECK(told(change, replaced(text, "\"NaN\"", "none")).empty());
  CHECK(told(change, replaced(text, "\"NaN\"", "(\"NaN\", none)")).empty());
}

TEST_CASE("two placeholders in one column do not hide each other") {
  auto const both = told([](int row, double&, double& level) {
    if (row == 150) level = -999;
    if (row == 151) level = 9999;
  });
  REQUIRE(both.size() == 2);
  CHECK(both[0].find("-999 mm in row 150,") != std::string::npos);
  CHECK(both[1].find("9999 mm in row 151,") != std::string::npos);
}

TEST_CASE("numbers are judged as they were written, whatever unit the model has") {
  auto const feet = told(
      [](int row, double&, double& level) {
        if (row == 150) level = 9999;
      },
      replaced(text, "level [mm]", "level [ft]"));
  REQUIRE(feet.size() == 1);
  CHECK(feet[0].find("is 9999 ft in row 150,") != std::string::npos);
}

TEST_CASE("nines within the range, impulses, other spikes and rows that the task does not read are left alone") {
  CHECK(told([](int, double&, double&) {}).empty());
  CHECK(told([](int row, double& force, double& level) {
          force *= 60;
          if (row == 150) force = 999, level = 9.99;
        }).empty());
  CHECK(told([](int row, double& force, double&) {
          force = row == 150 ? 999 : 0;  // a blow on nothing
        }).empty());
  CHECK(told([](int row, double& force, double&) {
          if (row == 150) force = 9876;
        }).empty());
  CHECK(told([](int row, double& force, double&) {
          if (row == 195) force = 9999;
        }).empty());
  // Simulation begins at row 1: its input acts, what was measured there is not scored.
  CHECK(told([](int row, double&, double& level) {
          if (row == 50) level = 9999;
        }).empty());
  CHECK(told([](int row, double& force, double&) {
          if (row == 50) force = 9999;
        }).size() == 1);
}

TEST_CASE("a fit says so before it begins and in its verdict, and check once for all tasks of a record") {
  TemporaryFolder folder;
  write_file(folder.path() / "record.csv", table([](int row, double& force, double&) {
               if (row == 150) force = 9999;
             }));
  RunOptions options;
  options.output = folder.path() / "results";
  RunResult const fitted = run_text(folder.path() / "m.sysid", text, options);
  CHECK(fitted.out.find("warning[looks_missing]: column `force` of record is 9999 mN in row 150") != std::string::npos);
  CHECK(fitted.notices.find("posterior: warning: column `force` of record is 9999 mN in row 150") != std::string::npos);
  std::string const twice = text + "again = fit m to record.middle with map, seed = 2\n";
  CHECK(messages(checked(folder.path() / "m.sysid", twice), "looks_missing").size() == 1);
}

TEST_CASE("a mark in a column whose unit the file states is named in that unit, and the cure for it works") {
  std::string const stated = replaced(
      replaced(replaced(replaced(text, "read missing = \"NaN\"", "read units = 2, missing = \"NaN\""), "time t [s]", "time t"),
               "force [mN]", "force"),
      "level [mm]", "level");
  auto const check = [](std::string const& file) {
    std::string table_with_units = table([](int row, double&, double& level) {
      if (row > 180) level = -9999;
    });
    table_with_units.insert(table_with_units.find('\n') + 1, "s,mN,mm\n");
    TemporaryFolder folder;
    write_file(folder.path() / "record.csv", table_with_units);
    return messages(checked(folder.path() / "m.sysid", file), "looks_missing");
  };
  auto const found = check(stated);
  REQUIRE(found.size() == 1);
  CHECK(found[0].find("column `level` of record is -9999 mm in rows 181, ") != std::string::npos);
  CHECK(check(replaced(stated, "missing = \"NaN\"", "missing = (\"NaN\", \"-9999\")")).empty());
}

TEST_CASE("zeros of a channel far from the rows beside them are named, those of an input at rest are not") {
  auto const dropped = told([](int row, double& force, double& level) {
    if (row % 9 == 0) level = 0;
    if (row % 7 == 0) force = 0;
  });
  REQUIRE(dropped.size() == 1);
  CHECK(dropped[0] ==
        "column `level` of record is 0 mm in rows 108, 117, 126, 135, 144 and 5 more, far from the numbers of the rows beside most "
        "of them: this may mark a missing value");
}
