// Records that begin in motion, of models with random states that begin at rest.
#include "diagnostics/residuals/start_far_off.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "core/numeric/random.hpp"
#include "diagnostics/residuals/residual_checks.hpp"
#include "load/load.hpp"

using namespace sysid;

namespace {

/// Findings of white innovations, but for the first ones.
Findings findings_of_start(std::string const& initial, std::vector<double> const& first, std::size_t missing = 0) {
  Source source("m.sysid", "model m {\n state y [mm]\n initial " + initial +
                               "\n parameter q [mm^2/s^3] ~ log_uniform(1e-4, 100)\n disturbance w [mm/s^2] ~ "
                               "white(intensity = q)\n y'' + 1 [1/s]*y' + 40 [1/s^2]*y = w\n"
                               " observe d [mm] ~ normal(y, sd = 0.1 [mm])\n}\n");
  Diagnostics diagnostics;
  auto const file = load(source, diagnostics);
  REQUIRE(file);
  constexpr std::size_t samples = 200;
  Stream stream({11, Purpose::test});
  Experiment experiment;
  experiment.name = "record";
  experiment.scored.assign(samples, 1);
  experiment.measured.resize(1);
  StandardisedRows rows{{{}}, {{}}};
  for (std::size_t i = 0; i < samples; ++i) {
    experiment.time.push_back(0.05 * static_cast<double>(i));
    double const residual = i < first.size() ? first[i] : stream.normal(), predicted = std::sin(0.3 * static_cast<double>(i));
    bool const there = i >= missing;
    experiment.measured[0].push_back(there ? 1e-3 * (predicted + 0.1 * residual) : std::nan(""));
    rows.residuals[0].push_back(there ? residual : std::nan(""));
    rows.predicted[0].push_back(predicted);
  }
  return check_residuals(file->models.front(), {experiment}, {rows}).findings;
}

Finding const* finding_with(Findings const& findings, FindingCode code) {
  for (Finding const& each : findings)
    if (each.code == code) return &each;
  return nullptr;
}

}  // namespace

TEST_CASE("a record that begins in motion is told to give the initial values a distribution, not to empty the row") {
  Findings const findings = findings_of_start("y = 0, y' = 0", {-11.7, 0.2, 4.6, 4.2});
  Finding const* const found = finding_with(findings, FindingCode::initial_far_off);
  REQUIRE(found != nullptr);
  CHECK(found->message.find("the first sample of d, row 1, lies 11.7 sds from where the model begins") != std::string::npos);
  CHECK(found->help.find("`initial y ~ normal(0, sd = 0.7 [mm])`") != std::string::npos);
  CHECK(finding_with(findings, FindingCode::samples_far_off) == nullptr);
  CHECK(finding_with(findings, FindingCode::noise_law) == nullptr);
}

TEST_CASE("noise and a disturbance that make up for a wrong start do not hide it, nor does a first row that is missing") {
  Findings const inflated = findings_of_start("y = 0, y' = 0", {-5.7, -5.5, -2});
  CHECK(finding_with(inflated, FindingCode::initial_far_off) != nullptr);
  CHECK(finding_with(inflated, FindingCode::samples_far_off) == nullptr);
  Findings const emptied = findings_of_start("y = 0, y' = 0", {0, -9, 3}, 1);
  Finding const* const found = finding_with(emptied, FindingCode::initial_far_off);
  REQUIRE(found != nullptr);
  CHECK(found->message.find("row 2") != std::string::npos);
}

TEST_CASE("a start that is near, one with a distribution and a spike later on are left alone") {
  CHECK(finding_with(findings_of_start("y = 0, y' = 0", {3.5}), FindingCode::initial_far_off) == nullptr);
  CHECK(finding_with(findings_of_start("y ~ normal(0, sd = 1 [mm]), y' = 0", {-11.7}), FindingCode::initial_far_off) == nullptr);
  Findings const spike = findings_of_start("y = 0, y' = 0", {0.1, 0.3, -0.2, 1, -1, 0.4, 12});
  CHECK(finding_with(spike, FindingCode::initial_far_off) == nullptr);
  CHECK(finding_with(spike, FindingCode::samples_far_off) != nullptr);
}

TEST_CASE("heavy tails of an estimated noise are named by their rows") {
  Stream stream({12, Purpose::test});
  std::vector<double> residuals;
  for (int i = 0; i < 200; ++i) residuals.push_back(0.7 * stream.normal());
  residuals[52] = 5.8;
  residuals[115] = -5.9;
  residuals[178] = 5.7;
  Findings const findings = findings_of_start("y = 0, y' = 0", residuals);
  Finding const* const found = finding_with(findings, FindingCode::noise_law);
  REQUIRE(found != nullptr);
  INFO(found->help);
  CHECK(found->help.find("row 116, 5.9 sds; row 53, 5.8 sds; row 179, 5.7 sds") != std::string::npos);
}
