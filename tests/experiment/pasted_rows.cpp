// Rows that stand in a file twice, and rows that only resemble earlier ones.
#include "experiment/pasted_rows.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <functional>

#include "app/checking.hpp"
#include "core/numeric/random.hpp"

using namespace sysid;

namespace {

std::vector<std::string> pasted_twice(CheckResult const& result) { return messages(result, "samples_repeated"); }

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
  CHECK(pasted_twice(line) ==
        std::vector<std::string>{
            "rows 61 to 80 of one repeat rows 31 to 50 in all columns that are used: each of these counts twice, "
            "and the sds come out too small"});
  CHECK(task(line, "fitted").findings.back().help == "if they were pasted twice, remove rows 61 to 80 from the file");
  CHECK(pasted_twice(check_pasted(line_model, of_line, 31, 30)).empty());  // none is pasted: what the help leaves
  CHECK(pasted_twice(check_pasted(arx_model, of_arx, 31, 60)) ==
        std::vector<std::string>{
            "rows 61 to 90 of one repeat rows 31 to 60 in all columns that are used: each of these counts twice, "
            "and the sds come out too small"});
}

TEST_CASE("few rows, few numbers and periodic records without noise are no rows pasted twice") {
  CHECK(pasted_twice(check_pasted(line_model, of_line, 31, 39)).empty());  // nine
  auto const few = [](int row) { return static_cast<double>(row * row * 7 % 11 % 3); };
  CHECK(pasted_twice(check_pasted(line_model, of_line, 31, 50, 6, few)).empty());
  CHECK(pasted_twice(check_pasted(arx_model, of_arx, 31, 49)).empty());
  auto const sine = [](int row) { return std::sin(2 * 3.14159265358979 * (row % 20) / 20) + 0.01 * (row % 20); };
  for (int const last : {0, 20, 40}) {  // of three periods and 100, 120, 140 rows
    CHECK(pasted_twice(check_pasted(arx_model, of_arx, 1, last, 6, sine)).empty());
    CHECK(pasted_twice(check_pasted(line_model, of_line, 1, last, 6, sine)).empty());
  }
}
