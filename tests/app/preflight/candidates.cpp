// Candidates that are one model under two names, and initial values that belong to another unit.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include "app/checking.hpp"
#include "app/running.hpp"

using namespace sysid;
using json = nlohmann::json;

namespace {

/// A car that slows down in air, from 12 m/s.
std::string const drag = R"(
model viscous {
  state v [m/s]
  initial v = 12
  parameter b [1/s] ~ log_uniform(0.01, 10)
  v' = -b*v
  observe speed ~ normal(v, sd = 0.06)
}
model quadratic {
  state v [m/s]
  initial v = 12
  parameter d [1/m] ~ log_uniform(0.001, 1)
  v' = -d*abs(v)*v
  observe speed ~ normal(v, sd = 0.06)
}
candidates drag { viscous; quadratic }
data run { file "coast.csv"; time t [s]; measure speed = speed [m/s] }
which = select drag to run with abc_smc(particles = 200), seed = 1
)";

std::string coasting() {
  std::string table = "t,speed\n";
  for (int row = 0; row < 60; ++row)
    table += fmt::format("{},{:.4g}\n", 0.25 * row, 12 / (1 + 12 * 0.09 * 0.25 * row) + 0.05 * (row % 3 - 1));
  return table;
}

CheckResult check_drag(std::string const& text) {
  TemporaryFolder folder;
  write_file(folder.path() / "coast.csv", coasting());
  return checked(folder.path() / "m.sysid", text);
}

std::string const copied = with(with(drag, "d [1/m]", "d [1/s]"), "v' = -d*abs(v)*v", "v' = -d*v");

}  // namespace

TEST_CASE("two candidates with one equation are named, in any order of its factors") {
  std::vector<std::string> const said = messages(check_drag(copied), "candidates_alike");
  REQUIRE(said.size() == 1);
  CHECK(said.front().starts_with("candidates `viscous` and `quadratic` have the same equations"));
  CHECK(
      messages(check_drag(with(with(copied, "v' = -b*v", "v' = -(b*v)"), "v' = -d*v", "v' = -(v*d)")), "candidates_alike").size() ==
      1);
  CHECK(messages(check_drag(with(copied, "speed ~ normal(v, sd = 0.06)", "speed ~ normal(v, sd = 0.05)")), "candidates_alike")
            .size() == 1);
}

TEST_CASE("candidates that differ in an equation, an initial value, the noise or a fixed number are not taken for one") {
  CHECK(messages(check_drag(drag), "candidates_alike").empty());
  std::size_t const second = copied.find("model quadratic");
  for (auto const& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"initial v = 12", "initial v = 11.9"}, {"sd = 0.06", "sd = 0.05"}, {"-d*v", "-d*v*2"}, {"-d*v", "-d*v - d*1 [m/s]"}})
    CHECK(messages(check_drag(copied.substr(0, second) + with(copied.substr(second), from, to)), "candidates_alike").empty());
}

TEST_CASE("one equation with priors that exclude each other is two hypotheses, and so are two priors of one model") {
  CHECK(messages(check_drag(with(copied, "d [1/s] ~ log_uniform(0.001, 1)", "d [1/s] ~ uniform(-1, 0)")), "candidates_alike")
            .empty());
  std::size_t const second = copied.find("model quadratic");
  std::string const renamed = with(with(copied.substr(second), "d [1/s]", "b [1/s]"), "-d*v", "-b*v");
  CHECK(messages(check_drag(copied.substr(0, second) + renamed), "candidates_alike").empty());
  std::string const twice = copied.substr(0, second) + with(renamed, "log_uniform(0.001, 1)", "log_uniform(0.01, 10)");
  CHECK(messages(check_drag(twice), "candidates_alike").size() == 1);
}

TEST_CASE("an initial value in another unit is named beside the first sample, and the right one is not") {
  std::size_t const second = drag.find("model quadratic");
  std::string const wrong = drag.substr(0, second) + with(drag.substr(second), "initial v = 12", "initial v = 12 [km/h]");
  CheckResult const result = check_drag(wrong);
  std::vector<std::string> const said = messages(result, "initial_far_off");
  REQUIRE(said.size() == 1);
  CHECK(said.front() == "`quadratic` begins with speed = 3.33 m/s, but its first sample, row 1 of run, is 11.9 m/s");
  CHECK(
      preflight(result, "which", "quadratic").findings.front().help ==
      "check `initial v` and its unit; if the initial value is not known, declare `parameter v_start [m/s] ~ normal(11.9, sd = 6)` "
      "and write `initial v = v_start`");
  // A fit reports it as `check` does.
  for (bool const off : {true, false}) {
    CAPTURE(off);
    std::string const fit = with(off ? wrong : drag, "which = select drag to run with abc_smc(particles = 200)",
                                 "which = fit quadratic to run with map");
    json const summary = CaseRun(fit, {{"coast.csv", coasting()}}).summary("which");
    auto const findings = summary.at("findings");
    CHECK(std::any_of(findings.begin(), findings.end(), [](json const& each) { return each.at("code") == "initial_far_off"; }) ==
          off);
  }
  CHECK(messages(check_drag(drag), "initial_far_off").empty());
  // A parameter that may have the right value is not doubted.
  CHECK(
      messages(check_drag(with(drag, "initial v = 12", "parameter v0 [m/s] ~ uniform(0, 30)\n  initial v = v0")), "initial_far_off")
          .empty());
}
