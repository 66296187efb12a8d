// Records that are counted twice: one file in two blocks, a copy, ranges that overlap; and records that only resemble each other.
#include "experiment/repeated_samples.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

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
