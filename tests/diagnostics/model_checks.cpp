// What a fit says of a model that predicts a channel worse than a constant would, and of channels of noise alone, where no model is
// better than that.
#include <doctest/doctest.h>

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "app/running.hpp"
#include "check/checking.hpp"
#include "core/numeric/random.hpp"
#include "diagnostics/model_checks.hpp"

using namespace sysid;
using nlohmann::json;

namespace {

// The findings of a fit by `map` of a model without dynamics to 200 samples of `value(stream)`.
template <class Value>
json findings_of(std::string const& statements, Value const& value) {
  TemporaryFolder folder;
  Stream stream({1, Purpose::test, 0, 0});
  std::string table = "x,y\n";
  for (int i = 0; i < 200; ++i) table += fmt::format("{},{}\n", i % 2 == 0 ? -1 : 1, value(stream));
  write_file(folder.path() / "record.csv", table);
  RunOptions options;
  options.output = folder.path() / "results";
  run_text(folder.path() / "m.sysid",
           "model m {\n input x [-]\n " + statements +
               "\n}\ndata record { file \"record.csv\"; input x = x [-]; measure y = y [-] }\n"
               "posterior = fit m to record with map, seed = 1\n",
           options);
  return json::parse(read_file(options.output / "posterior/summary.json")).at("findings");
}

bool has(json const& findings, std::string const& code) {
  for (json const& finding : findings)
    if (finding.at("code") == code) return true;
  return false;
}

}  // namespace

TEST_CASE("a fit that predicts worse than the mean of the record says so, however wide its noise") {
  // The record lies about 5, the model about 0: sums of squares about 25 and 0.01 a sample.
  json const findings = findings_of(
      "parameter a [-] ~ normal(0, sd = 1)\n parameter s [-] ~ log_uniform(0.01, 100)\n observe y ~ "
      "normal(a*x, sd = s)",
      [](Stream& stream) { return 5 + 0.1 * stream.normal(); });
  CHECK(has(findings, "worse_than_the_mean"));
}

TEST_CASE("nothing is said where there is nothing to explain") {
  auto const silent = [](std::string const& statements, auto const& value) {
    return !has(findings_of(statements, value), "worse_than_the_mean");
  };
  CHECK(silent("parameter a [-] ~ normal(0, sd = 1)\n observe y ~ normal(a*x, sd = 1)", [](Stream& s) { return s.normal(); }));
  CHECK(silent("parameter r [-] ~ log_uniform(0.1, 100)\n observe y ~ poisson(r)",
               [](Stream& s) { return std::floor(4 * s.uniform()); }));
  // About its median the mean square of a log-normal variate of sd 1 is 109 % of its variance: logarithms are compared.
  CHECK(silent("parameter r [-] ~ log_uniform(0.1, 100)\n observe y ~ log_normal(r, sd = 1)",
               [](Stream& s) { return std::exp(s.normal()); }));
}

TEST_CASE("noise with heavy tails is of the size that it states, and of half of that it is not") {
  auto const outlying = [](Stream& stream) {  // Student's t of three degrees of freedom
    double sum = 0;
    for (int i = 0; i < 3; ++i) sum += std::pow(stream.normal(), 2) / 3;
    return stream.normal() / std::sqrt(sum);
  };
  std::string const mean = "parameter a [-] ~ normal(0, sd = 1)\n ";
  CHECK_FALSE(has(findings_of(mean + "observe y ~ student_t(a*x, 3, scale = 1)", outlying), "noise_size"));
  CHECK_FALSE(has(findings_of(mean + "parameter n ~ log_uniform(1, 100)\n parameter s [-] ~ log_uniform(0.1, 10)\n observe y ~ "
                                     "student_t(a*x, n, scale = s)",
                              outlying),
                  "noise_size"));
  CHECK(has(findings_of(mean + "observe y ~ student_t(a*x, 3, scale = 0.5)", outlying), "noise_size"));
  CHECK(has(findings_of(mean + "observe y ~ student_t(a*x, 3, scale = 2)", outlying), "noise_size"));
}

TEST_CASE("an offset explains residuals that are too large, not those that are too small") {
  auto const help = [](double size) {
    int row = 0;
    json const findings =
        findings_of("parameter a [-] ~ normal(0, sd = 1e3)\n observe y ~ normal(a*x, sd = 10)",
                    [&](Stream& stream) { return size * (0.5 + (row++ % 2 == 0 ? -2 : 2) + 0.1 * stream.normal()); });
    for (json const& finding : findings)
      if (finding.at("code") == "noise_size") return finding.at("help").get<std::string>();
    return std::string();
  };
  CHECK(help(1) == "the stated noise is too large: estimate it");
  CHECK(help(100).find("add the offset first") != std::string::npos);
}

TEST_CASE("chains that do not mix are told of their population, unless its members are sampled relative to it") {
  Model const model = test::model_of(
      "input x [-]\n parameter mu [-] ~ normal(0, sd = 1)\n parameter tau [-] ~ half_normal(1)\n"
      "parameter k per experiment [-] ~ normal(mu, sd = tau)\n observe y ~ normal(k*x, sd = 1)");
  Draws draws;
  draws.chains.resize(1);
  draws.chains.front().values = {{0, 1, 0}, {0, 1, 0}};
  Findings const unmixed = {{FindingCode::ess_bulk_low, Severity::error, {"tau"}, "", ""}};
  std::vector<std::string> const members = {"k"}, others = {"c"};
  CHECK(check_hierarchy(model, draws, unmixed).front().code == FindingCode::hierarchy_narrows);
  CHECK(check_hierarchy(model, draws, unmixed, others).size() == 1);
  CHECK(check_hierarchy(model, draws, unmixed, members).empty());
  CHECK(check_hierarchy(model, draws, {}).empty());
}

TEST_CASE("an idle parameter is warned of, unless arguments of the model may have switched its terms off") {
  Model const model = test::model_of(
      "state y\ninitial y = 1\nparameter k ~ normal(1, sd = 1)\nparameter k3 ~ normal(1, sd = 1)\ny' = -k*y - 0*k3*y^3\n"
      "observe d ~ normal(y, sd = 1)");
  auto const severity = [&](std::function<bool(std::string const&)> const& switched_off) {
    Findings const idle = check_use(model, {}, switched_off);
    REQUIRE(idle.size() == 1);
    CHECK(idle[0].names == std::vector<std::string>{"k3"});
    return idle[0].severity;
  };
  CHECK(severity(nullptr) == Severity::warning);
  CHECK(check_use(model, {}, nullptr).front().message.ends_with("its posterior equals its prior"));
  CHECK(check_use(model, {}, nullptr, true).front().message.ends_with("its value and sd in this result say nothing about it"));
  CHECK(severity([](std::string const& name) { return name == "k3"; }) == Severity::note);
  CHECK(severity([](std::string const& name) { return name == "k"; }) == Severity::warning);
}

TEST_CASE("of a model with arguments a parameter that no term of its text reads is warned of, one that an argument idles noted") {
  TemporaryFolder folder;
  Stream stream({1, Purpose::test, 0, 0});
  std::string table = "x,y\n";
  for (int i = 0; i < 40; ++i) table += fmt::format("{},{}\n", i % 2 == 0 ? -1 : 1, stream.normal());
  write_file(folder.path() / "record.csv", table);
  RunOptions options;
  options.output = folder.path() / "results";
  run_text(folder.path() / "m.sysid",
           "model line(cubic) {\n input x [-]\n parameter a [-] ~ normal(0, sd = 1)\n parameter b [-] ~ normal(0, sd = 1)\n"
           " parameter spare [-] ~ normal(0, sd = 1)\n observe y ~ normal(a*x + cubic*b*x^3, sd = 1)\n}\n"
           "data record { file \"record.csv\"; input x = x [-]; measure y = y [-] }\n"
           "posterior = fit line(cubic = 0) to record with map, seed = 1\n",
           options);
  json const summary = json::parse(read_file(options.output / "posterior/summary.json"));
  std::map<std::string, std::string> severities;
  for (json const& each : summary.at("findings"))
    if (each.at("code") == "unused_parameter") severities[each.at("message").get<std::string>().substr(0, 2)] = each.at("severity");
  CHECK(severities == std::map<std::string, std::string>{{"b ", "note"}, {"sp", "warning"}});
}

TEST_CASE("where a fit explains little, a negative value that the model fixes is named") {
  Model const model = test::model_of(
      "state y [m]\ninitial y = 1\nparameter k [1/s] ~ normal(1, sd = 1)\nparameter c [1/s] = -20\nparameter d [1/s] = 2\n"
      "parameter unread [kg] = -1\ny' = -k*y - c*y - d*y\nobserve z ~ normal(y, sd = 1)");
  Findings findings = {{FindingCode::explains_little, Severity::warning, {}, "", "look"},
                       {FindingCode::residuals_not_white, Severity::warning, {}, "", "look"}};
  name_negative_values(model, findings);
  CHECK(findings[0].help == "look; check the sign of what the model fixes at a negative value: c = -20 1/s");
  CHECK(findings[1].help == "look");
}
