// export as a user calls it: partial work, files of other programs beside results, folders that were moved.
#include <doctest/doctest.h>

#include "cli/asked.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

/// A second fit, of a model that Stan cannot be told of.
std::string const decay = R"(
model decay {
  state y
  initial y = 1
  parameter rate [1/s] ~ log_uniform(0.1, 10)
  y' = -rate*y
  observe size ~ normal(y, sd = 0.1)
}
data dish {
  file    "bench.csv"
  time    u [s]
  measure size = d
}
stiff = fit decay to dish with map, solver = cvode, seed = 1
)";

}  // namespace

TEST_CASE("fits that Stan can be told of are written, the others named with their places") {
  LineDesk const desk(decay);
  Said const said = desk.ask("export line.sysid --stan");
  CHECK(said.exit == 1);
  CHECK(said.text.find("results/posterior/posterior.stan\nresults/posterior/posterior.data.json\n") != std::string::npos);
  CHECK(said.text.find("error: `stiff` cannot be written as a Stan program: it is integrated by cvode") != std::string::npos);
  CHECK(said.text.find("line.sysid:25:9: ") != std::string::npos);
  CHECK(desk.has("results/posterior/posterior.stan"));
  CHECK_FALSE(desk.has("results/stiff"));

  Said const again = desk.ask("export line.sysid --stan");
  CHECK(again.exit == 65);
  CHECK(again.text.find("sysid: error: `results/posterior/posterior.stan` exists already\nhelp: add --force to replace it\n") !=
        std::string::npos);
}

TEST_CASE("a file in the place of results is told apart from a folder that is not there") {
  LineDesk const desk;
  Said const said = desk.ask("export line.sysid");
  CHECK(said.exit == 65);
  CHECK(said.text.starts_with("sysid: error: `line.sysid` is a file, not a folder of results\nhelp: "));
  CHECK(desk.ask("export nowhere").exit == 74);
}

TEST_CASE("where no fit can be written, the exit code is that of a mistake in the file") {
  LineDesk const desk;
  desk.save("stiff.sysid", decay);
  CHECK(desk.ask("export stiff.sysid --stan").exit == 65);
}

TEST_CASE("what was exported of results goes with them when they are replaced") {
  LineDesk const desk;
  REQUIRE(desk.ask("fit line.sysid --quiet --no-figures").exit <= 1);
  REQUIRE(desk.ask("export results --draws 0").exit == 0);
  REQUIRE(desk.ask("export results --stan").exit == 0);
  for (char const* ending : {".nc", ".stan", ".data.json"}) CHECK(desk.has(std::string("results/posterior/posterior") + ending));
  REQUIRE(desk.ask("fit line.sysid --quiet --no-figures --force").exit <= 1);
  for (char const* ending : {".nc", ".stan", ".data.json"})
    CHECK_FALSE(desk.has(std::string("results/posterior/posterior") + ending));
}

TEST_CASE("a program that was exported before the run is kept until force is asked for") {
  LineDesk const desk;
  REQUIRE(desk.ask("export line.sysid --stan").exit == 0);
  CHECK(desk.ask("fit line.sysid --no-figures").exit == 65);
  CHECK(desk.has("results/posterior/posterior.stan"));
}

TEST_CASE("a folder of results may be renamed and moved") {
  LineDesk const desk("forecast = predict posterior on bench with draws(10), seed = 1\n");
  REQUIRE(desk.ask("run line.sysid --quiet --no-figures").exit <= 1);
  std::filesystem::rename(desk.path("results/posterior"), desk.path("kept"));
  Said const said = desk.ask("export kept");
  CHECK(said.exit == 0);
  CHECK(said.text.find("kept/posterior.nc: posterior, sample_stats, observed_data") != std::string::npos);
  CHECK(desk.ask("export kept --stan").exit == 0);
  CHECK(desk.has("kept/posterior.stan"));
}
