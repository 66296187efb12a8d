// Records that are counted twice: one file in two blocks, a copy, ranges that overlap; and records that only resemble each other.
#include "experiment/repeated_samples.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <functional>

#include "app/checking.hpp"
#include "core/numeric/random.hpp"

using namespace sysid;

namespace {

// A decay with noise; `digits` after the point. The noise is that of the seed.
std::string decay_table(std::uint64_t seed, int digits, int rows = 60) {
  std::string text = "t,y,z\n";
  Stream stream({seed, Purpose::test, 0, 0});
  for (int row = 0; row < rows; ++row)
    text += fmt::format("{:.6g},{:.{}f},{:.{}f}\n", 0.1 * row, 100.0 / (1 + row) + 0.3 * stream.normal(), digits,
                        50.0 / (1 + row) + 0.3 * stream.normal(), digits);
  return text;
}

std::string const decay_model =
    "model m {\n state y [m]\n initial y = 0.1\n parameter c [1/s] ~ log_uniform(0.1, 10)\n y' = -c*y\n"
    " observe z [m] ~ normal(y, sd = 0.001 [m])\n}\n";

CheckResult check_two(std::string const& first, std::string const& second, std::string const& table, std::string const& copy,
                      std::string const& to = "one, two") {
  TemporaryFolder folder;
  write_file(folder.path() / "a.csv", table);
  write_file(folder.path() / "b.csv", copy);
  return checked(folder.path() / "m.sysid", decay_model + "data one { " + first + " }\ndata two { " + second +
                                                " }\nfitted = fit m to " + to + " with map, seed = 1\n");
}

std::vector<std::string> repeated(CheckResult const& result) { return messages(result, "samples_repeated"); }

std::string const of_a = "file \"a.csv\"; time t [s]; measure z = y [mm]", of_b = "file \"b.csv\"; time t [s]; measure z = y [mm]";

}  // namespace

TEST_CASE("one file in two blocks, a copy of it, and ranges that overlap are counted twice") {
  std::string const table = decay_table(1, 6);
  CHECK(repeated(check_two(of_a, of_a, table, table)) ==
        std::vector<std::string>{
            "one and two have 60 samples of z in common (they read the same file): each of these counts twice, and "
            "the sds come out too small"});
  CHECK(repeated(check_two(of_a, of_b, table, table)).size() == 1);
  CHECK(repeated(check_two(of_a, "file \"b.csv\"; time t [s]; measure z = y [um]", table, table)).empty());  // other numbers
  CHECK(repeated(check_two(of_a + "; split early = rows 1..30", of_a + "; split late = rows 21..60", table, table,
                           "one.early, two.late"))
            .front()
            .starts_with("one.early and two.late have 10 samples of z in common"));
}

TEST_CASE("the help of samples that repeat leaves none") {
  std::string const table = decay_table(1, 6);
  CHECK(repeated(check_two(of_a, of_a, table, table, "one")).empty());
  CHECK(repeated(check_two(of_a + "; split early = rows 1..20", of_a + "; split late = rows 21..60", table, table,
                           "one.early, two.late"))
            .empty());
}

TEST_CASE("two tests alike, other columns of one file and counts that agree by chance are no repetition") {
  CHECK(repeated(check_two(of_a, of_b, decay_table(1, 6), decay_table(2, 6))).empty());
  CHECK(repeated(check_two(of_a, of_b, decay_table(1, 0), decay_table(2, 0))).empty());  // a quarter of the rows agree
  CHECK(repeated(check_two(of_a, "file \"a.csv\"; time t [s]; measure z = z [mm]", decay_table(1, 6), "t,y\n")).empty());
  std::string steps = "t,y,z\n";
  for (int row = 0; row < 60; ++row) steps += fmt::format("{:.6g},{},0\n", 0.1 * row, row < 30 ? 1 : 0);
  CHECK(repeated(check_two(of_a, of_b, steps, steps)).empty());  // two numbers only
}

namespace {

// Rows of a regression, or of a difference equation: what is pasted behind row 60 is rows `first` to `last`.
CheckResult check_pasted(std::string const& model, std::string const& block, int first, int last, int digits = 6,
                         std::function<double(int)> const& wave = nullptr) {
  Stream stream({3, Purpose::test, 0, 0});
  std::vector<std::string> rows;
  for (int row = 0; row < 100; ++row) {
    double const load = wave ? wave(row) : 5 + stream.normal(), gap = wave ? 2 * wave(row) : 2 + stream.normal();
    rows.push_back(fmt::format("{},{:.{}f},{:.{}f}\n", row, load, digits, gap, digits));
  }
  std::string table = "n,load,gap\n";
  for (int row = 0; row < 60; ++row) table += rows[static_cast<std::size_t>(row)];
  for (int row = first; row <= last; ++row) table += rows[static_cast<std::size_t>(row - 1)];
  for (int row = 60; row < 100; ++row) table += rows[static_cast<std::size_t>(row)];
  TemporaryFolder folder;
  write_file(folder.path() / "a.csv", table);
  return checked(folder.path() / "m.sysid",
                 model + "data one { file \"a.csv\"; " + block + " }\nfitted = fit m to one with map, seed = 1\n");
}

std::string const line_model =
    "model m {\n input load\n parameter a ~ normal(0, sd = 2)\n parameter b ~ normal(0, sd = 2)\n"
    " observe gap ~ normal(a + b*load, sd = 1)\n}\n";
std::string const arx_model =
    "model m {\n time discrete 0.5 [s]\n input load\n parameter a ~ normal(0, sd = 2)\n parameter b ~ normal(0, sd = 2)\n"
    " observe gap ~ normal(a*lag(measured(gap), 1) + b*lag(load, 1), sd = 1)\n}\n";
std::string const of_line = "input load = load; measure gap = gap", of_arx = "step 0.5 [s]; " + of_line;

}  // namespace

TEST_CASE("rows of a regression, or without times, that were pasted twice are named, and without them there are none") {
  CheckResult const line = check_pasted(line_model, of_line, 31, 50);
  CHECK(repeated(line) == std::vector<std::string>{
                              "rows 61 to 80 of one repeat rows 31 to 50 in all columns that are used: each of these counts twice, "
                              "and the sds come out too small"});
  CHECK(task(line, "fitted").findings.back().help == "if they were pasted twice, remove rows 61 to 80 from the file");
  CHECK(repeated(check_pasted(line_model, of_line, 31, 30)).empty());  // none is pasted: what the help leaves
  CHECK(repeated(check_pasted(arx_model, of_arx, 31, 60)) ==
        std::vector<std::string>{
            "rows 61 to 90 of one repeat rows 31 to 60 in all columns that are used: each of these counts twice, "
            "and the sds come out too small"});
}

TEST_CASE("few rows, few numbers and periodic records without noise are no rows pasted twice") {
  CHECK(repeated(check_pasted(line_model, of_line, 31, 39)).empty());  // nine
  auto const few = [](int row) { return static_cast<double>(row * row * 7 % 11 % 3); };
  CHECK(repeated(check_pasted(line_model, of_line, 31, 50, 6, few)).empty());
  CHECK(repeated(check_pasted(arx_model, of_arx, 31, 49)).empty());
  auto const sine = [](int row) { return std::sin(2 * 3.14159265358979 * (row % 20) / 20) + 0.01 * (row % 20); };
  for (int const last : {0, 20, 40}) {  // of three periods and 100, 120, 140 rows
    CHECK(repeated(check_pasted(arx_model, of_arx, 1, last, 6, sine)).empty());
    CHECK(repeated(check_pasted(line_model, of_line, 1, last, 6, sine)).empty());
  }
}
