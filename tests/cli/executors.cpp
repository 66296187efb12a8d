// What runs the simulations changes nothing in the results, and machine code that cannot be had is no error.
#include <doctest/doctest.h>

#include "cli/asked.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

constexpr char const* fitted_mass = R"(model mass {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter c [N s/m] ~ log_uniform(2, 200)
  parameter k [N/m] ~ log_uniform(1e3, 1e5)
  1 [kg]*y'' + c*y' + k*y = x
  observe d ~ normal(y, sd = 1e-6)
}
data bench {
  file    "bench.csv"
  time    t
  input   x = x hold zero_order
  measure d = d
}
posterior = fit mass to bench with mh(samples = 100, burn_in = 50, chains = 2), seed = 1
)";

void save_record(Desk const& desk) {
  std::string csv = "t,x,d\n";
  double y = 0, v = 0;
  for (int i = 0; i < 120; ++i) {
    double const x = i % 17 < 8 ? 10 : -10;
    csv += std::to_string(0.001 * i) + "," + std::to_string(x) + "," + std::to_string(y) + "\n";
    for (int s = 0; s < 10; ++s) {
      v += 1e-4 * (x - 20 * v - 1e4 * y);
      y += 1e-4 * v;
    }
  }
  desk.save("bench.csv", csv);
  desk.save("mass.sysid", fitted_mass);
}

std::string draws(Desk const& desk, std::string const& folder) {
  return read_file(desk.path(folder + "/posterior/draws_1.csv")) + read_file(desk.path(folder + "/posterior/summary.json")) +
         read_file(desk.path(folder + "/posterior/predict.csv"));
}

}  // namespace

TEST_CASE("every executor writes the same bytes") {
  Desk const desk;
  save_record(desk);
  REQUIRE(desk.ask("fit mass.sysid --no-figures --quiet -o auto").exit <= 1);
  for (std::string const executor : {"scalar", "lanes", "native"}) {
    Said const said = desk.ask("fit mass.sysid --no-figures -o " + executor + " --executor " + executor);
    CHECK_MESSAGE(said.exit <= 1, said.text);
    CHECK_MESSAGE(said.text.find("machine code is not available") == std::string::npos, said.text);
    CHECK(draws(desk, executor) == draws(desk, "auto"));
    std::string const timing = read_file(desk.path(executor + "/posterior/timing.json"));
    CHECK_MESSAGE(timing.find("\"executor\": \"" + executor + "\"") != std::string::npos, timing);
  }
  Said const said = desk.ask("fit mass.sysid --executor gpu");
  CHECK(said.exit == 2);
}

TEST_CASE("without the compiler of machine code simulations are interpreted, with one notice") {
  Desk const desk;
  save_record(desk);
  REQUIRE(desk.ask("fit mass.sysid --no-figures --quiet -o with").exit <= 1);
  std::filesystem::copy_file(SYSID_PROGRAM, desk.path("alone"));  // away from its module
  Said const said =
      said_by("cd '" + desk.path(".").string() + "' && ./alone fit mass.sysid --no-figures -o without --executor native");
  CHECK_MESSAGE(said.exit <= 1, said.text);
  auto const notice = said.text.find("machine code is not available, simulations are interpreted: ");
  CHECK_MESSAGE(notice != std::string::npos, said.text);
  CHECK(said.text.find("machine code", notice + 1) == std::string::npos);
  CHECK(draws(desk, "with") == draws(desk, "without"));
}
