// Experiments of one fit that do not agree: a shared parameter, a member of a population.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "app/running.hpp"
#include "core/numeric/random.hpp"

using namespace sysid;
using json = nlohmann::json;

namespace {

/// A decaying swing of 12 rad/s over 4 s, recorded by a clock that runs `clock` times as fast.
std::string swing(double clock, std::uint64_t record) {
  std::string rows = "t,y\n";
  Stream stream({.seed = 6, .purpose = Purpose::test, .index = record, .step = 0});
  for (int i = 0; i < 160; ++i) {
    double const t = 0.025 * i;
    rows += fmt::format("{:.9g},{:.9g}\n", t * clock, std::exp(-0.3 * t) * std::cos(12 * t) + 0.02 * stream.normal());
  }
  return rows;
}

std::string const swings =
    "model o {\n  state y\n  parameter y0 per experiment ~ normal(0, sd = 3)\n  parameter v0 per experiment [1/s] ~ normal(0, sd = "
    "40)\n  initial y = y0, y' = v0\n  parameter z [1/s] ~ log_uniform(0.01, 10)\n  parameter w [rad/s] ~ log_uniform(5, 30)\n"
    "  parameter s ~ log_uniform(0.001, 5)\n  y'' + 2*z*y' + w^2*y = 0\n  observe d ~ normal(y, sd = s)\n}\n"
    "data one { file \"one.csv\"; time t [s]; measure d = y }\ndata two { file \"two.csv\"; time t [s]; measure d = y }\n"
    "both = fit o to one, two with map, seed = 1\n";

std::string const springs = [] {
  std::string text =
      "model spring {\n  input F [N]\n  parameter mu [N/mm] ~ log_uniform(1, 200)\n  parameter tau ~ half_normal(sd = 0.5)\n"
      "  parameter k per experiment [N/mm] ~ log_normal(median = mu, sd = tau)\n  parameter s [mm] ~ log_uniform(0.001, 1)\n"
      "  observe d ~ normal(F/k, sd = s)\n}\n";
  std::string all;
  for (int e = 0; e < 8; ++e) {
    text += fmt::format("data e{0} {{ file \"e{0}.csv\"; input F = F; measure d = d [mm] }}\n", e);
    all += fmt::format("{}e{}", e == 0 ? "" : ", ", e);
  }
  return text + "b = fit spring to " + all + " with mh(samples = 4000, burn_in = 1500), seed = 1\n";
}();

/// Springs of about 11 N/mm that scatter by a tenth; the last column of the last file times `unit`.
std::vector<std::pair<std::string, std::string>> benches(double unit) {
  std::vector<std::pair<std::string, std::string>> files;
  for (int e = 0; e < 8; ++e) {
    Stream stream({.seed = 7, .purpose = Purpose::test, .index = static_cast<std::uint64_t>(e), .step = 0});
    double const k = 11 * std::exp(0.1 * stream.normal());
    std::string rows = "F,d\n";
    for (int i = 1; i <= 10; ++i)
      rows += fmt::format("{},{:.9g}\n", 5 * i, (5 * i / k + 0.1 * stream.normal()) * (e == 7 ? unit : 1));
    files.emplace_back(fmt::format("e{}.csv", e), std::move(rows));
  }
  return files;
}

std::vector<json> findings_named(json const& summary, std::string const& code) {
  std::vector<json> all;
  for (json const& each : summary.at("findings"))
    if (each.at("code") == code) all.push_back(each);
  return all;
}

}  // namespace

TEST_CASE("a clock that runs at another rate in one of two experiments is a parameter about which they disagree") {
  auto const disagreements = [](double clock) {
    CaseRun const run(swings, {{"one.csv", swing(1, 1)}, {"two.csv", swing(clock, 2)}});
    return findings_named(run.summary("both"), "experiments_disagree");
  };
  std::vector<json> const said = disagreements(1 / 1.02);
  REQUIRE(said.size() == 1);
  CAPTURE(said.front().at("message").get<std::string>());
  CHECK(said.front().at("names").at(0) == "w");
  CHECK(said.front().at("message").get<std::string>().starts_with("the experiments disagree about `w`: 1"));
  CHECK(disagreements(1).empty());
}

TEST_CASE("a disturbance does not hide that experiments disagree") {
  std::string text = with(
      swings, "  y'' + 2*z*y' + w^2*y = 0",
      "  parameter q [1/s^3] ~ log_uniform(1e-6, 1e4)\n  disturbance f [1/s^2] ~ white(intensity = q)\n  y'' + 2*z*y' + w^2*y = f");
  for (double const clock : {1 / 1.02, 1.0}) {
    CAPTURE(clock);
    CaseRun const run(text, {{"one.csv", swing(1, 1)}, {"two.csv", swing(clock, 2)}});
    CHECK(findings_named(run.summary("both"), "experiments_disagree").size() == (clock == 1 ? 0 : 1));
  }
}

TEST_CASE("a member in another unit is far from the other members, although it has widened their population") {
  for (double const unit : {0.1, 1.0}) {
    CAPTURE(unit);
    CaseRun const run(springs, benches(unit));
    std::vector<json> const said = findings_named(run.summary("b"), "member_far_off");
    REQUIRE(said.size() == (unit == 1 ? 0 : 1));
    if (said.empty()) continue;
    CHECK(said.front().at("names").at(0) == "k[e7]");
    CHECK(said.front().at("message").get<std::string>().find("about 10 times their mean") != std::string::npos);
  }
}
