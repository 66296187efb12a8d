// Numbers written where a sensor gave none, in inputs and in what is measured: `check` names their rows, and so does a fit.
#include "app/placeholders.hpp"

#include <doctest/doctest.h>

#include <fmt/format.h>

#include "app/checking.hpp"
#include "app/running.hpp"
#include "core/elementary.hpp"

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
    "data record { file \"record.csv\"; time t [s]; input u = force [mN] hold linear; measure z = level [mm]; split middle = rows "
    "101..190 }\n"
    "posterior = fit m to record.middle with map, seed = 1\n";

template <class Change>
std::vector<std::string> told(Change const& change) {
  TemporaryFolder folder;
  write_file(folder.path() / "record.csv", table(change));
  return messages(checked(folder.path() / "m.sysid", text), "looks_missing");
}

}  // namespace

TEST_CASE("a 9999 in an input and in a channel is named with its rows, in declared units, as is the end of a converter's range") {
  auto const input = told([](int row, double& force, double&) {
    if (row == 150) force = 9999;
  });
  REQUIRE(input.size() == 1);
  CHECK(input[0] == "u is 9.999 N in row 150 of record.middle, far from all its other samples: is it a missing value?");
  auto const channel = told([](int row, double&, double& level) {
    if (row > 180) level = -999;
  });
  REQUIRE(channel.size() == 1);
  CHECK(
      channel[0] ==
      "z is -0.999 m in rows 181, 182, 183, 184, 185 and 5 more of record.middle, far from all its other samples: is it a missing "
      "value?");
  CHECK(told([](int row, double& force, double& level) {
          if (row == 120) force = -32768, level = 65535;
        }).size() == 2);
}

TEST_CASE("nines within the range, impulses, other spikes and rows behind those of the task are left alone") {
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
}

TEST_CASE("a fit says so, too") {
  TemporaryFolder folder;
  write_file(folder.path() / "record.csv", table([](int row, double& force, double&) {
               if (row == 150) force = 9999;
             }));
  RunOptions options;
  options.output = folder.path() / "results";
  CHECK(run_text(folder.path() / "m.sysid", text, options).out.find("warning[looks_missing]: u is 9.999 N in row 150") !=
        std::string::npos);
}
