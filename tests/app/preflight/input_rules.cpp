// What `check` reads off the samples of an input about the rule between them.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include "app/checking.hpp"
#include "app/running.hpp"
#include "core/numeric/random.hpp"

using namespace sysid;

namespace {

/// Two seconds at 100 Hz. cycles: of a sine, in Hz; 0: each sample drawn for itself, as a generator's that holds it.
std::string record(double cycles) {
  Stream stream({.seed = 3, .purpose = Purpose::test, .index = 0, .step = 0});
  std::string table = "t,u,y\n";
  for (int i = 0; i < 200; ++i) {
    double const t = i / 100.0, u = cycles > 0 ? std::sin(2 * 3.14159265358979 * cycles * t) : 2 * stream.uniform() - 1;
    table += fmt::format("{},{:.9f},{:.9f}\n", t, u, 0.5 * u + 0.01 * (i % 3));
  }
  return table;
}

std::vector<Finding> findings_of(std::string const& rule, double cycles) {
  TemporaryFolder folder;
  write_file(folder.path() / "record.csv", record(cycles));
  CheckResult const result =
      checked(folder.path() / "lag.sysid",
              "model lag { input u; state y; initial y = 0; parameter k ~ log_uniform(0.1, 1000); y' = k*(u - y); observe out ~ "
              "normal(y, sd = 0.1) }\ndata bench { file \"record.csv\"; time t [s]; input u = u hold " +
                  rule + "; measure out = y }\nposterior = fit lag to bench with map\n");
  std::vector<Finding> found;
  for (Finding const& each : task(result, "posterior").findings)
    if (each.code == FindingCode::input_rule || each.code == FindingCode::input_band) found.push_back(each);
  return found;
}

}  // namespace

TEST_CASE("a smooth input under straight lines is sent to `cubic`, under `cubic` nothing is said of it") {
  auto const lines = findings_of("linear", 12);
  REQUIRE(lines.size() == 1);
  CHECK(lines.front().names == std::vector<std::string>{"u", "bench", "cubic"});
  CHECK(lines.front().help == "write `hold cubic` if the input was sampled from a smooth signal");
  CHECK(findings_of("cubic", 12).empty());
  CHECK(findings_of("linear", 1).empty());  // two hundredths of a cycle from sample to sample: lines leave out nothing
}

TEST_CASE("an input that its samples do not determine is sent to `zero_order`, of a held one nothing is said") {
  for (char const* rule : {"linear", "cubic"}) {
    CAPTURE(rule);
    auto const found = findings_of(rule, 0);
    REQUIRE(found.size() == 1);
    CHECK(found.front().names == std::vector<std::string>{"u", "bench", "zero_order"});
  }
  CHECK(findings_of("zero_order", 0).empty());
}

TEST_CASE("power beyond the band of `band_limited` is a warning, inside of it none") {
  auto const white = findings_of("band_limited", 0);
  REQUIRE(white.size() == 1);
  CHECK(white.front().code == FindingCode::input_band);
  CHECK(findings_of("band_limited", 12).empty());
}
