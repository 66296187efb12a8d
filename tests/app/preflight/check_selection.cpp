// `sysid check` of a selection: every candidate is looked at, and weighs by what it does to the probabilities.
#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/checking.hpp"
#include "app/running.hpp"
#include "diagnostics/verdict.hpp"
#include "relative.hpp"
#include "report/page/check_page.hpp"

using namespace sysid;

namespace {

Finding const* find(PreflightPage const& preflight, std::string_view code) {
  for (Finding const& each : preflight.findings)
    if (word(each.code) == code) return &each;
  return nullptr;
}

/// A selection among `candidates` of Duffing's oscillator, whose shipped text is the beginning.
std::string duffing_selection(std::string const& model, std::string const& task) {
  std::string const text = shipped("duffing/duffing.sysid");
  std::string const data = text.substr(text.find("data bench"), text.find("truth ") - text.find("data bench"));
  return text.substr(0, text.find("data bench")) + model + data + task;
}

}  // namespace

TEST_CASE("each candidate has its own part of the page, in text and JSON") {
  CheckResult const result = checked(models / "bouc_wen/bouc_wen.sysid", shipped("bouc_wen/bouc_wen.sysid"));
  TaskPage const& page = task(result, "selection");
  REQUIRE(page.preflights.size() == 5);
  std::string const shown = check_text(result.page);
  nlohmann::json const object = nlohmann::json::parse(check_json(result.page, ""));
  nlohmann::json const& said = object.at("tasks").at(1).at("candidates");
  REQUIRE(said.size() == 5);
  std::size_t at = 0;
  for (std::size_t k = 0; k < 5; ++k) {
    PreflightPage const& each = page.preflights[k];
    CHECK(each.candidate == (k == 0 ? "linear" : "bouc_wen(n = " + std::to_string(k) + ")"));
    at = shown.find(" candidate " + each.candidate + "\n", at);
    CHECK(at != std::string::npos);
    CHECK(said.at(k).at("name") == each.candidate);
    CHECK(said.at(k).at("prior").at("draws") == 128);
    CHECK(said.at(k).at("information").at("parameters").size() == (k == 0 ? 4 : 6));
    CHECK(said.at(k).at("information").at("response_move") == *each.information->response_move);
    CHECK(each.information->taken == "rk4(substeps = 1)");
  }
  CHECK(object.at("tasks").at(0).at("candidates").empty());
  // What the finer steps show grows with the power in the equation, and stays below what noise of 1 % leaves: 0.01 nmse.
  CHECK(*page.preflights[1].information->response_move < *page.preflights[4].information->response_move);
  CHECK(100 * std::pow(*page.preflights[4].information->response_move, 2) < 0.01);
}

TEST_CASE("a candidate that leaves a direction open is warned of, a rival in order beside it is not") {
  std::string const rival = R"(
model scaled {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter m [kg] ~ log_uniform(0.1, 10)
  parameter b ~ log_uniform(0.1, 10)
  parameter c [N s/m] ~ log_uniform(2, 200)
  parameter k [N/m] ~ log_uniform(1e3, 1e5)
  parameter beta [1/m^2] ~ log_uniform(1e8, 1e13)
  m*y'' + c*y' + k*y = b*x
  observe displacement [m] ~ normal(y, precision = beta)
}
candidates both { duffing; scaled }
)";
  CheckResult const result = checked(models / "duffing/both.sysid",
                                     duffing_selection(rival, "which = select both to bench.train with abc_smc(), seed = 1\n"));
  CHECK(preflight(result, "which", "duffing").findings.empty());
  PreflightPage const& scaled = preflight(result, "which", "scaled");
  Finding const* const found = find(scaled, "not_identifiable");
  REQUIRE(found != nullptr);
  CHECK(found->severity == Severity::warning);
  CHECK(found->message.find("scaling m, b, c and k together leaves displacement unchanged") == 0);
  CHECK(grade(result.page) == Severity::warning);
}

TEST_CASE("the integrator of a selection is judged by what it does to distances") {
  std::string const task = "which = select duffing to bench.train with abc_smc(), seed = 1";
  PreflightPage const rk4 =
      preflight(checked(models / "duffing/one.sysid", duffing_selection("", task + "\n")), "which", "duffing");
  CHECK(rk4.findings.empty());
  // Parameters would move by more than a tenth of an sd, which a fit that states its steps is warned of.
  CHECK(rk4.information->moves.front().second > 0.1);
  // Some ten samples to a period.
  std::string const fast =
      with(duffing_selection("", task + ", solver = heun\n"), "log_uniform(1e3, 1e5)", "log_uniform(2e5, 1e6)");
  PreflightPage const heun = preflight(checked(models / "duffing/one.sysid", fast), "which", "duffing");
  REQUIRE_FALSE(heun.findings.empty());
  CHECK(heun.findings.back().code == FindingCode::integration_step);
  CHECK(heun.findings.back().message.find("the distances depend on the accuracy of heun(substeps = 1)") == 0);
  // Noise that is stated says where distances end: an sd of 1e-8 m is far below what half a step changes.
  std::string const quiet =
      with(duffing_selection("", task + "\n"), "beta [1/m^2] ~ log_uniform(1e8, 1e13)", "beta [1/m^2] = 1e16");
  PreflightPage const exact = preflight(checked(models / "duffing/one.sysid", quiet), "which", "duffing");
  REQUIRE(find(exact, "integration_step") != nullptr);
  CHECK(find(exact, "integration_step")->message.find("times the distance due to the stated noise") != std::string::npos);
}

TEST_CASE("prior mass that cannot be simulated is a candidate's handicap: a note, and a warning where it may decide") {
  auto const severity_of = [](std::string const& low, std::string const& high) {
    std::string const text = with(duffing_selection("", "which = select duffing to bench.train with abc_smc(), seed = 1\n"),
                                  "log_uniform(5e8, 5e10)", "uniform(" + low + ", " + high + ")");
    PreflightPage const page = preflight(checked(models / "duffing/soft.sysid", text), "which", "duffing");
    Finding const* const found = find(page, "prior_fails");
    REQUIRE(found != nullptr);
    double const share = static_cast<double>(page.prior->failed) / page.prior->draws;
    return std::pair(found->severity, share);
  };
  auto const [some, few] = severity_of("-1e11", "1e11");
  CHECK(few > 0.2);
  CHECK(few < 1 - 1 / 3.2);
  CHECK(some == Severity::note);
  auto const [most, many] = severity_of("-1e12", "1e11");
  CHECK(many > 1 - 1 / 3.2);
  CHECK(many < 1);
  CHECK(most == Severity::warning);
}

TEST_CASE("what moves a jump of the equations has its slopes, though fixed steps show none") {
  // z follows x up to yield, and stays: d force / d yield is 1 on the samples beyond, and 0 before.
  TemporaryFolder folder;
  std::string table = "t,x,force\n";
  for (int i = 0; i <= 100; ++i)
    table += std::to_string(i) + "," + std::to_string(0.1 * i) + "," + std::to_string(std::min(0.1 * i, 5.02)) + "\n";
  write_file(folder.path() / "ramp.csv", table);
  CheckResult const result = checked(folder.path() / "ramp.sysid", R"(
model slider {
  input x
  state z
  initial z = 0
  parameter yield ~ normal(5.02, sd = 0.005)
  z' = if abs(z) >= yield and z*x' > 0 then 0 else x'
  observe force ~ normal(z, sd = 0.001)
}
data bench { file "ramp.csv"; time t [s]; input x = x hold linear; measure force = force }
best = fit slider to bench with map
)");
  PreflightPage const& page = preflight(result, "best");
  REQUIRE(page.information);
  CHECK(page.information->null_directions.empty());
  // Quantiles of 128 normal draws at one sd have an sd of 13 % of it; half the difference of two, a tenth.
  CHECK(page.information->lines.at(0).prior_width == relative(0.005, 0.3));
  // Fifty samples, x = 5.1 to 10, and a prior of its own sd: 1/sqrt(50/0.001^2 + 1/0.005^2), the prior's sd taken from 128 draws.
  double const expected = 1 / std::sqrt(50 / (0.001 * 0.001) + 1 / (0.005 * 0.005));
  CHECK(page.information->lines.at(0).low == relative(expected, 1e-3));
  CHECK(page.information->lines.at(0).high == relative(expected, 1e-3));
}
