// Fits whose solver is exact: their result is that of small steps, their table says why the step is not checked, and rules between
// samples that the step does not suit are tried all the same.
#include <doctest/doctest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/running.hpp"
#include "app/tables.hpp"
#include "relative.hpp"

using namespace sysid;
using nlohmann::json;

namespace {

// tasks: of the record `truth`, whose force is as `made` says between its samples.
std::string oscillator(std::string const& made, std::string const& hold, std::string const& tasks) {
  return fmt::format(R"(
model oscillator {{
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter m [kg] ~ log_uniform(0.5, 2)
  parameter c [N s/m] ~ log_uniform(0.5, 50)
  parameter k [N/m] ~ log_uniform(100, 1e4)
  parameter sigma [m] ~ log_uniform(1e-6, 1e-1)
  m*y'' + c*y' + k*y = x
  observe displacement ~ normal(y, sd = sigma)
}}
truth = simulate oscillator with values(m = 1, c = 3, k = 900, sigma = 1e-5), {}, noise = model, samples = 400, rate = 100 [Hz], seed = 1
data bench {{
  file "results/truth/truth.csv"
  time t [s]
  input x = x [N] hold {}
  measure displacement = displacement [m]
}}
{}
)",
                     made, hold, tasks);
}

json const* finding_of(json const& summary, std::string const& code) {
  for (json const& each : summary.at("findings"))
    if (each.at("code") == code) return &each;
  return nullptr;
}

json check_row(json const& summary, std::string const& name) {
  for (json const& each : summary.at("checks"))
    if (each.at("name") == name) return each;
  return {};
}

}  // namespace

TEST_CASE("a fit by exact steps is that of many small ones, and says why it has no step to check") {
  CaseRun const run(oscillator("input x = gaussian(sd = 1, hold = linear), solver = exponential", "linear", R"(
exact = fit oscillator to bench with map, solver = exponential, seed = 1
small = fit oscillator to bench with map, solver = rk4(substeps = 64), seed = 1
other = simulate oscillator with values(m = 1, c = 3, k = 900, sigma = 1e-5), input x = gaussian(sd = 1, hold = linear), noise = model,
    samples = 200, rate = 37 [Hz], seed = 2
data slower {
  file "results/other/other.csv"
  time t [s]
  input x = x [N] hold linear
  measure displacement = displacement [m]
}
forecast = predict exact on slower with seed = 1
by_small = predict small on slower with seed = 1)"),
                    {});
  CHECK(run.result.exit == 0);
  json const exact = run.summary("exact"), small = run.summary("small");
  CHECK(exact.at("settings").at("solver") == "exponential");
  CHECK_FALSE(exact.at("settings").contains("substeps"));
  for (char const* const name : {"m", "c", "k", "sigma"}) {
    CAPTURE(name);
    json const found = parameter(exact, name), expected = parameter(small, name);
    double const sd = expected.at("sd").get<double>();
    CHECK(std::abs(found.at("mean").get<double>() - expected.at("mean").get<double>()) < 0.01 * sd);
    CHECK(found.at("sd").get<double>() == relative(sd, 0.01));
  }
  CHECK(check_row(exact, "solver_accuracy").at("reason").get<std::string>().find("is exact") != std::string::npos);
  CHECK(check_row(small, "solver_accuracy").at("ran") == true);
  CHECK(finding_of(exact, "input_rule") == nullptr);
  // With a step of its own.
  std::vector<double> const forecast = column(run.file("forecast/predict.csv"), "displacement_mean"),
                            by_small = column(run.file("by_small/predict.csv"), "displacement_mean");
  REQUIRE(forecast.size() == 200);
  for (std::size_t i = 0; i < forecast.size(); ++i) CHECK(std::abs(forecast[i] - by_small[i]) < 2e-6);
}

TEST_CASE("rules between samples that an exact step does not suit are tried by another solver") {
  CaseRun const run(
      oscillator(
          "input x = multisine(sd = 3 [N], lowest = 1 [Hz], highest = 20 [Hz], hold = cubic), solver = dopri5(relative = 1e-10)",
          "zero_order", "held = fit oscillator to bench with map, solver = exponential, seed = 1"),
      {});
  json const held = run.summary("held");
  json const* const told = finding_of(held, "input_rule");
  REQUIRE(told != nullptr);
  CHECK(told->at("help").get<std::string>().find("hold cubic") != std::string::npos);
}
