// The table of checks of a finished fit: every row runs or says why not, for each kind of likelihood, and rows that both share find
// the same mistakes with a Gaussian process.
#include <doctest/doctest.h>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/fit/fit_checks.hpp"
#include "app/running.hpp"
#include "core/numeric/random.hpp"

using namespace sysid;
using nlohmann::json;

namespace {

bool says(json const& summary, std::string const& code) {
  for (json const& each : summary.at("findings"))
    if (each.at("code") == code) return true;
  return false;
}

json check(json const& summary, std::string const& name) {
  for (json const& each : summary.at("checks"))
    if (each.at("name") == name) return each;
  return {};
}

/// Every row of the table, in its order.
void check_rows(json const& summary) {
  json const& checks = summary.at("checks");
  std::vector<FitCheckRow> rows(fit_check_rows().begin(), fit_check_rows().end());
  std::erase_if(rows, [](FitCheckRow const& row) { return row.of_filters; });
  REQUIRE(checks.size() == rows.size());
  for (std::size_t k = 0; k < checks.size(); ++k) {
    CAPTURE(checks[k].dump());
    CHECK(checks[k].at("name") == std::string(rows[k].name));
    bool const ran = checks[k].at("ran").get<bool>();
    CHECK(checks[k].contains("reason") == !ran);
    if (!ran) CHECK_FALSE(checks[k].at("reason").get<std::string>().empty());
  }
}

/// 150 samples of an oscillator under a force that is held over each sample, and a sensor that is not linear.
std::string bench() {
  Stream stream({9, Purpose::test, 0, 0});
  std::string rows = "t,force,reading\n";
  double y = 0, v = 0;
  for (int i = 0; i < 150; ++i) {
    double const force = 12 * stream.normal();
    rows += fmt::format("{},{},{}\n", i * 0.02, force, y + 3 * y * y + 2e-4 * stream.normal());
    for (int n = 0; n < 50; ++n) {
      v += 0.0004 * (force - 2 * v - 400 * y);
      y += 0.0004 * v;
    }
  }
  return rows;
}

json fitted_with_hold(std::string const& rule) {
  CaseRun const run(R"(
model bent {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter c     [N s/m] ~ log_normal(median = 3, sd = 1)
  parameter k     [N/m]   ~ log_normal(median = 300, sd = 0.7)
  parameter sigma [m]     ~ log_normal(median = 1e-3, sd = 1.5)
  function f(at) ~ gp(squared_exponential(amplitude = 0.01 [m], length = 0.1 [m]))
  1 [kg]*y'' + c*y' + k*y = x
  observe reading [m] ~ normal(y + f(y), sd = sigma)
}
data bench { file "bench.csv"; time t [s]; input x = force [N] hold )" +
                        rule + R"(; measure reading = reading [m] }
best = fit bent to bench with map, seed = 1
)",
                    {{"bench.csv", bench()}});
  return run.summary("best");
}

}  // namespace

TEST_CASE("every check of a fit runs or says why it does not apply, with a process and without") {
  std::string const data =
      "data points { file \"points.csv\"; input x = x; measure y = y }\nbest = fit toy to points with map, seed = 1\n";
  std::string const points = "x,y\n1,2.1\n2,2.7\n3,3.6\n4,4.1\n5,4.4\n6,5.0\n";
  std::string const head =
      "model toy {\n input x\n parameter a ~ normal(0, sd = 3)\n parameter s ~ log_normal(median = 0.1, sd = 1)\n";
  CaseRun const plain(head + " observe y ~ normal(a*x, sd = s)\n}\n" + data, {{"points.csv", points}});
  CaseRun const process(head + " function f(u) ~ gp(squared_exponential(amplitude = 0.3, length = 2))\n" +
                            " observe y ~ normal(a*x + f(x), sd = s)\n}\n" + data,
                        {{"points.csv", points}});
  for (json const& summary : {plain.summary("best"), process.summary("best")}) {
    check_rows(summary);
    CHECK(check(summary, "residuals").at("ran") == true);
    CHECK(check(summary, "input_timing").at("reason") == "the model uses no input between samples");
    CHECK(check(summary, "hierarchy").at("reason") == "no parameter is estimated per experiment");
  }
}

TEST_CASE("an input with the wrong rule between samples is found beside a process") {
  json const wrong = fitted_with_hold("linear"), right = fitted_with_hold("zero_order");
  CHECK(says(wrong, "input_rule"));
  CHECK_FALSE(says(right, "input_rule"));
  CHECK(check(right, "input_timing").at("ran") == true);
}

TEST_CASE("an optimum of a population is warned of beside a process") {
  CaseRun const run(R"(
model toy {
  input x
  parameter mean   ~ normal(0, sd = 5)
  parameter spread ~ log_normal(median = 1, sd = 1)
  parameter offset per experiment ~ normal(mean, sd = spread)
  parameter sigma  ~ log_normal(median = 0.1, sd = 1)
  function f(u) ~ gp(squared_exponential(amplitude = 1, length = 2))
  observe y ~ normal(offset + f(x), sd = sigma)
}
data one { file "one.csv"; input x = x; measure y = y }
data two { file "two.csv"; input x = x; measure y = y }
best = fit toy to one, two with map, seed = 1
)",
                    {{"one.csv", "x,y\n1,2.1\n2,2.7\n3,2.6\n4,2.1\n5,1.4\n6,1.0\n"},
                     {"two.csv", "x,y\n1,3.0\n2,3.8\n3,3.5\n4,3.2\n5,2.3\n6,2.1\n"}});
  CHECK(says(run.summary("best"), "optimum_of_hierarchy"));
}

TEST_CASE("a sample without a value beside a process takes its own band away and no other") {
  CaseRun const run(R"(
model toy {
  input x
  parameter a ~ normal(0, sd = 3)
  parameter s ~ log_normal(median = 0.1, sd = 1)
  function f(u) ~ gp(squared_exponential(amplitude = 0.3, length = 2))
  observe y ~ normal(a*sqrt(x) + f(x), sd = s)
}
data points { file "points.csv"; input x = x; measure y = y }
best = fit toy to points with map, seed = 1
)",
                    {{"points.csv", "x,y\n1,2.1\n2,2.7\n3,3.6\n4,4.1\n5,4.4\n6,5.0\n-1,\n"}});
  json const summary = run.summary("best");
  CHECK_FALSE(says(summary, "undefined_in_band"));
  CHECK(summary.at("verdict").at("pass") == true);  // the fit itself does not read that row
  std::istringstream predictions(run.file("best/predict.csv"));
  std::vector<std::string> lines;
  for (std::string line; std::getline(predictions, line);)
    if (!line.starts_with("#")) lines.push_back(line);
  REQUIRE(lines.size() == 8);
  for (std::size_t i = 1; i < lines.size(); ++i) CHECK((lines[i].find("NaN") != std::string::npos) == (i == 7));
}
