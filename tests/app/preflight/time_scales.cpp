// A time in years beside rates per second, and models that are stiff or slow, which are something else.
#include "app/preflight/time_scales.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <regex>

#include "app/checking.hpp"
#include "app/running.hpp"
#include "core/numeric/elementary.hpp"
#include "report/page/check_page.hpp"

using namespace sysid;

namespace {

std::string const growth =
    "model grow {\n state N [-]\n parameter N0 [-] ~ log_uniform(0.1, 100)\n initial N = N0\n"
    " parameter r [1/s] ~ log_uniform(0.01, 10)\n parameter K [-] ~ log_uniform(1, 1000)\n"
    " N' = r*N*(1 - N/K)\n observe count ~ log_normal(N, sd = 0.05)\n}\n"
    "data rec { file \"record.csv\"; time year [year]; measure count = N }\n"
    "post = fit grow to rec with map, seed = 1\n";

CheckResult check_population(std::string const& text) {
  std::string table = "year,N\n";
  for (int row = 0; row < 40; ++row) table += fmt::format("{},{:.6g}\n", 0.5 * row, 80 / (1 + 15 * elementary::exp(-0.5 * row)));
  TemporaryFolder folder;
  write_file(folder.path() / "record.csv", table);
  return checked(folder.path() / "m.sysid", text);
}

Finding const* apart(CheckResult const& result) {
  for (Finding const& each : preflight(result, "post").findings)
    if (each.code == FindingCode::time_scales_apart) return &each;
  return nullptr;
}

}  // namespace

TEST_CASE("rates per second beside a time in years are named, and neither stiffness nor an input is") {
  CheckResult const result = check_population(growth);
  Finding const* const found = apart(result);
  REQUIRE(found != nullptr);
  CHECK(found->message.starts_with("rec lasts 19.5 year, which is 6.2e8 s, but at every prior draw even the slowest motion"));
  CHECK(messages(result, "stiff_prior").empty());
  for (Finding const& each : preflight(result, "post").findings) CHECK(each.help.find("input") == std::string::npos);

  std::smatch line;
  REQUIRE(std::regex_search(found->help, line, std::regex("`(parameter r [^`]*)`")));
  CheckResult const cured = check_population(with(growth, "parameter r [1/s]", line[1].str()));
  CHECK(apart(cured) == nullptr);
  CHECK(messages(cured, "stiff_prior").empty());
  CHECK(messages(cured, "prior_fails").empty());
}

TEST_CASE("what no step is taken for fails by no step, and at no time") {
  std::string table = "x,y\n";
  for (int row = 0; row < 40; ++row) table += fmt::format("{},1\n", 0.1 * row);
  TemporaryFolder folder;
  write_file(folder.path() / "record.csv", table);
  std::string const priors = " input x\n parameter a ~ normal(0, sd = 1)\n parameter b ~ normal(0, sd = 1)\n";
  for (auto const& [model, time] :
       {std::pair(priors + " observe z ~ normal(b*log(a + x), sd = 1)\n", ""),
        std::pair(" time discrete 1 [s]\n" + priors + " observe z ~ normal(b*lag(measured(z), 1) + log(a) + x, sd = 1)\n",
                  "step 1 [s]; ")}) {
    CAPTURE(model);
    CheckResult const result =
        checked(folder.path() / "m.sysid", "model m {\n" + model + "}\ndata rec { file \"record.csv\"; " + time +
                                               "input x = x; measure z = y }\npost = fit m to rec with map, seed = 1\n");
    CHECK(messages(result, "integration_step").empty());
    CHECK_FALSE(messages(result, "prior_fails").empty());
    for (Finding const& each : preflight(result, "post").findings) CHECK(each.help.find("unit of time") == std::string::npos);
    CHECK((check_text(result.page).find("first at t = ") == std::string::npos) == (*time == '\0'));
  }
}

TEST_CASE("the same time read in seconds is the other cure") {
  CHECK(apart(check_population(with(growth, "year [year]", "year [s]"))) == nullptr);
}

TEST_CASE("a model with one fast motion and one as slow as the record is stiff, not in another unit") {
  std::string const stiff =
      "model fastslow {\n state a [-], b [-]\n initial a = 0, b = 1\n parameter eps [s] ~ log_uniform(1e-6, 1e-5)\n"
      " parameter g [1/s] ~ log_uniform(0.05, 5)\n eps*a' = b - a - a^3\n b' = -g*b\n"
      " observe count ~ normal(a, sd = 0.05)\n}\ndata rec { file \"record.csv\"; time year [s]; measure count = N }\n"
      "post = fit fastslow to rec with map, seed = 1\n";
  CheckResult const result = check_population(stiff);
  CHECK(apart(result) == nullptr);
  CHECK_FALSE(messages(result, "stiff_prior").empty());
}

namespace {

/// An oscillator of 1 to 350 Hz whose record has a row every 2 ms.
std::string const vibration =
    "model rig {\n input x [N]\n state y [mm]\n initial y = 0, y' = 0\n parameter m [kg] ~ log_uniform(0.1, 20)\n"
    " parameter c [N s/m] ~ log_uniform(1, 200)\n parameter k [N/mm] ~ log_uniform(1, 500)\n m*y'' + c*y' + k*y = x\n"
    " observe position ~ normal(y, sd = 0.01)\n}\n"
    "data shaker { file \"record.csv\"; time t [ms]; input x = force [N] hold zero_order; measure position = pos [mm] }\n"
    "post = fit rig to shaker with map, solver = rk4, seed = 1\n";

CheckResult check_vibration(std::string const& text) {
  std::string table = "t,force,pos\n";
  for (int row = 0; row < 120; ++row)
    table += fmt::format("{},{},{:.5g}\n", 2 * row, row % 7 - 3, 0.5 * elementary::sin(0.2 * row));
  TemporaryFolder folder;
  write_file(folder.path() / "record.csv", table);
  return checked(folder.path() / "m.sysid", text);
}

}  // namespace

TEST_CASE("milliseconds that are read as seconds are named, by any solver, and its line is the cure") {
  CHECK(apart(check_vibration(vibration)) == nullptr);
  for (std::string const solver : {"rk4", "dopri5", "cvode"}) {
    CAPTURE(solver);
    std::string const wrong = with(with(vibration, "t [ms]", "t [s]"), "solver = rk4", "solver = " + solver);
    CheckResult const result = check_vibration(wrong);
    Finding const* const found = apart(result);
    REQUIRE(found != nullptr);
    CHECK(found->message.starts_with(
        "rows of shaker are 2.0 s apart, but at every prior draw even the slowest motion of `rig` is over"));
    CHECK(found->help.starts_with("correct the unit of `time` in `shaker`: `time t [ms]` if its numbers are milliseconds"));
    CHECK(messages(result, "stiff_prior").empty());
  }
  CheckResult const some_slow = check_vibration(
      with(with(with(vibration, "t [ms]", "t [s]"), "k [N/mm] ~ log_uniform(1, 500)", "k [N/mm] ~ log_uniform(0.5, 500)"),
           "c [N s/m] ~ log_uniform(1, 200)", "c [N s/m] ~ log_uniform(1, 400)"));
  REQUIRE(apart(some_slow) != nullptr);
  CHECK(apart(some_slow)->message.find(" of 64 prior draws even the slowest motion") != std::string::npos);
  CHECK(apart(check_vibration(with(with(vibration, "t [ms]", "t [s]"), "k [N/mm] ~ log_uniform(1, 500)",
                                   "k [N/m] ~ log_uniform(1, 500)"))) == nullptr);
}

TEST_CASE("motions without damping do not count as growing by the last digit of an eigenvalue") {
  std::string const chain =
      "model rig {\n input x [N]\n state a [mm], b [mm], c [mm]\n initial a = 0, a' = 0, b = 0, b' = 0, c = 0, c' = 0\n"
      " constant m [kg] = 1\n parameter k [N/mm] ~ log_uniform(1, 500)\n m*a'' = x - k*(a - b)\n m*b'' = k*(a - 2*b + c)\n"
      " m*c'' = k*(b - 2*c)\n observe position ~ normal(a, sd = 0.01)\n}\n"
      "data shaker { file \"record.csv\"; time t [s]; input x = force [N] hold zero_order; measure position = pos [mm] }\n"
      "post = fit rig to shaker with map, solver = rk4, seed = 1\n";
  CHECK(apart(check_vibration(chain)) != nullptr);
  CHECK(apart(check_vibration(with(chain, "time t [s]", "time t [ms]"))) == nullptr);
}

TEST_CASE("a check ends where a solver with its own steps needs very many of them") {
  // The same with a slow state beside the fast motion, so that the rows show something: only the number of steps is left.
  std::string text = with(with(vibration, "t [ms]", "t [s]"), "solver = rk4", "solver = cvode");
  text = with(with(text, " state y [mm]\n initial y = 0", " state y [mm], s [-]\n initial s = 1, y = 0"), " observe position",
              " parameter r [1/s] ~ log_uniform(0.001, 0.01)\n s' = -r*s\n observe position");
  CheckResult const result = check_vibration(text);
  CHECK(apart(result) == nullptr);
  std::vector<std::string> const said = messages(result, "prior_fails");
  REQUIRE(said.size() == 1);
  CHECK(said.front().find(" steps of cvode between two samples: `check` leaves these draws out") != std::string::npos);
  for (Finding const& each : preflight(result, "post").findings)
    if (each.code == FindingCode::prior_fails) CHECK(each.help.starts_with("check the unit of time in the data block first"));
  CHECK(messages(check_vibration(with(text, "t [s]", "t [ms]")), "prior_fails").empty());
}

TEST_CASE("a run names the units where it finds no start") {
  std::string table = "year,N\n", said;
  for (int row = 0; row < 40; ++row) table += fmt::format("{},{}\n", 0.5 * row, 5 + 2 * row);
  try {
    CaseRun const run(growth, {{"record.csv", table}});
  } catch (UserError const& error) {
    said = error.what();
  }
  CHECK(said.find("units of the rates are wrong") != std::string::npos);
  CHECK(said.find("stiff") == std::string::npos);
}
