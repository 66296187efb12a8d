// What predictions say of the trajectories that their bands leave out.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/running.hpp"
#include "core/numeric/elementary.hpp"
#include "core/numeric/random.hpp"

using namespace sysid;
using json = nlohmann::json;

namespace {

json finding_in(json const& summary, std::string const& code) {
  for (json const& each : summary.at("findings"))
    if (each.at("code") == code) return each;
  return nullptr;
}

/// The first parameter of all draws.
std::vector<double> first_parameter(CaseRun const& run, std::string const& task) {
  std::vector<double> values;
  for (int chain = 1; chain <= 4; ++chain) {
    std::istringstream lines(read_file(run.folder.path() / "results" / task / ("draws_" + std::to_string(chain) + ".csv")));
    std::size_t column = 0;
    bool header = true;
    for (std::string line; std::getline(lines, line);) {
      if (line.empty() || line[0] == '#') continue;
      std::vector<std::string> cells;
      std::istringstream row(line);
      for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
      if (header) {
        while (cells.at(column) != "r") ++column;
        header = false;
      } else {
        values.push_back(std::stod(cells.at(column)));
      }
    }
  }
  return values;
}

// y = 1/(1 - r t), which is not there from t = 1/r on; measured while it is.
std::string const growth = R"(
model growth {
  state y
  initial y = 1
  parameter r [1/s] ~ normal(0, sd = 0.3)
  y' = r*y^2
  observe o ~ normal(y, sd = 0.3)
}
data short { file "short.csv"; time t [s]; measure o = o }
data long { file "long.csv"; time t [s]; measure o = o }
past = fit growth to short with mh(samples = 1500, burn_in = 500, thin = 20, chains = 4), substeps = 16, seed = 1
)";
std::pair<std::string, std::string> const early = {"short.csv", "t,o\n0,1\n1,1.2\n2,1.5\n3,1.9\n"};

std::string rows_to(int last) {
  std::string text = "t,o\n";
  for (int t = 0; t <= last; ++t) text += std::to_string(t) + ",1\n";
  return text;
}

}  // namespace

TEST_CASE("trajectories that fail are counted with their place, and from a fifth on the prediction fails with them") {
  CaseRun const run(growth + "later = predict past on long with draws(200), seed = 1\n", {early, {"long.csv", rows_to(40)}});
  json const summary = run.summary("later");
  // The posterior lies about r = 0.16: with pole at 6 s, far below 40 s; a tenth of it is not left.
  int const failed = summary.at("ledger").at("failed").get<int>();
  CHECK(failed > 180);
  CHECK(summary.at("ledger").at("solves") == 200);
  CHECK(summary.at("ledger").at("failures").at(0).at("where").get<std::string>().find("y^2") != std::string::npos);
  json const said = finding_in(summary, "failed_predictions");
  REQUIRE(!said.is_null());
  CHECK(said.at("severity") == "error");
  CHECK(said.at("message").get<std::string>().find(std::to_string(failed) + " of 200 trajectories") == 0);
  CHECK(summary.at("verdict").at("pass") == false);
  CHECK(run.result.exit == static_cast<int>(ExitCode::doubtful));
}

TEST_CASE("trajectories that stay finite are no finding") {
  CaseRun const run(growth + "later = predict past on long with draws(200), seed = 1\n", {early, {"long.csv", rows_to(2)}});
  json const summary = run.summary("later");
  CHECK(summary.at("ledger").at("failed") == 0);
  CHECK(finding_in(summary, "failed_predictions").is_null());
  // Only the fit's own doubt is carried on: its chains are short.
  for (json const& each : summary.at("findings")) CHECK(each.at("code") == "from_doubtful_fit");
}

TEST_CASE("draws without a value of a derived quantity are counted, and the quantity is named") {
  CaseRun const run(R"(
model line {
  input x
  parameter r ~ normal(0, sd = 2)
  observe o ~ normal(r*x, sd = 0.3)
  derive margin = sqrt(r*x - 0.42*x)
  derive slope = r*x
  derive root = sqrt(r - 0.42)
}
data bench { file "bench.csv"; input x = x; measure o = o }
line_fit = fit line to bench with mh(samples = 1500, burn_in = 500, thin = 20, chains = 4), seed = 1
again = predict line_fit on bench with draws(200), seed = 1
)",
                    {{"bench.csv", "x,o\n1,0.7\n2,0.5\n3,1.4\n1.5,0.6\n"}});
  std::vector<double> const r = first_parameter(run, "line_fit");
  REQUIRE(r.size() == 200);  // each is predicted once
  auto const below = std::count_if(r.begin(), r.end(), [](double value) { return value < 0.42; });
  REQUIRE(below > 10);
  json const said = finding_in(run.summary("again"), "undefined_in_band");
  REQUIRE(!said.is_null());
  CHECK(said.at("severity") == "warning");
  CHECK(said.at("message") ==
        "margin is undefined somewhere along " + std::to_string(below) + " of 200 trajectories; its band contains only the others");
  CHECK(finding_in(run.summary("again"), "failed_predictions").is_null());
  json const fitted = run.summary("line_fit");
  CHECK_FALSE(finding_in(fitted, "undefined_in_band").is_null());
  // One number of each draw has no band.
  CHECK(std::ranges::any_of(fitted.at("findings"), [&](json const& each) {
    return each.at("message") ==
           "root is undefined at " + std::to_string(below) + " of 200 draws, so it has no mean and no quantiles";
  }));
}

TEST_CASE("a prediction from an optimum has the band of its noise, and is told where that misses the samples") {
  Stream stream({5, Purpose::test, 0, 0});
  std::string table = "x,o\n";
  for (int row = 0; row < 200; ++row) {
    double const x = 0.01 * row;
    table += fmt::format("{},{}\n", x, 2 * x + (row < 100 ? 0.3 : 1.2) * stream.normal());
  }
  CaseRun const run(
      "model line { input x\n parameter r ~ normal(0, sd = 5)\n observe o ~ normal(r*x, sd = 0.3) }\n"
      "data bench { file \"bench.csv\"; input x = x; measure o = o; split early = rows 1..100, late = rows 101..200 }\n"
      "best = fit line to bench.early with map, seed = 1\n"
      "same = predict best on bench.early with draws(400), seed = 1\n"
      "one = predict best on bench.early with draws(1), seed = 1\n"
      "late = predict best on bench.late with draws(400), seed = 1\n",
      {{"bench.csv", table}});
  auto const coverage = [&](char const* task) { return run.summary(task).at("fit").at("coverage_95").get<double>(); };
  for (char const* task : {"same", "one"}) {
    CHECK(coverage(task) > 0.88);  // of 0.95 with 100 samples: 3 sds
    CHECK(finding_in(run.summary(task), "coverage_low").is_null());
  }
  CHECK(coverage("late") < 0.6);
  CHECK_FALSE(finding_in(run.summary("late"), "coverage_low").is_null());
}

TEST_CASE("scores on rows that were fitted are called so; scores on others are not") {
  std::string const parts = with(growth, "past = fit growth to short",
                                 "data cut { file \"long.csv\"; time t [s]; measure o = o; "
                                 "split train = rows 1..6, test = rows 7..9 }\n"
                                 "past = fit growth to cut.train");
  auto const predicted = [&](std::string const& on) {
    CaseRun const run(parts + "forecast = predict past on " + on + " with draws(20), seed = 1\n",
                      {early, {"long.csv", rows_to(8)}});
    return finding_in(run.summary("forecast"), "fitted_rows_predicted");
  };
  json const same = predicted("cut.train");
  REQUIRE_FALSE(same.is_null());
  CHECK(same.at("severity") == "note");
  CHECK(same.at("message") ==
        "all 6 scored rows of cut.train are rows that `past` was fitted to: the scores do not show how well it predicts");
  CHECK(predicted("cut.test").is_null());
  // Another block of the same file.
  json const overlapping = predicted("long");
  REQUIRE_FALSE(overlapping.is_null());
  CHECK(overlapping.at("message").get<std::string>().starts_with("6 of 9 scored rows of long"));
  // By another path, and in a copy.
  for (std::string const path : {"./long.csv", "copy.csv"}) {
    CAPTURE(path);
    std::string const text = with(parts, "data cut { file \"long.csv\"", "data cut { file \"" + path + "\"");
    CaseRun const run(text + "forecast = predict past on long with draws(20), seed = 1\n",
                      {early, {"long.csv", rows_to(8)}, {"copy.csv", rows_to(8)}});
    CHECK_FALSE(finding_in(run.summary("forecast"), "fitted_rows_predicted").is_null());
  }
}

namespace {

// A spring of unknown law under a force of this amplitude, followed by Euler's steps of 1 ms.
std::string pulled(double amplitude) {
  std::string text = "t,x,o\n";
  double y = 0, v = 0;
  Stream noise({3, Purpose::noise, 0, 0});
  for (int i = 0; i < 200; ++i) {
    double const t = 0.05 * i, x = amplitude * elementary::sin(0.9 * t) * elementary::sin(0.17 * t + 1);
    text += fmt::format("{:.6g},{:.9g},{:.9g}\n", t, x, y + 0.002 * noise.normal());
    for (int k = 0; k < 50; ++k) {
      double const at = t + 0.001 * k;
      v += 0.001 * (amplitude * elementary::sin(0.9 * at) * elementary::sin(0.17 * at + 1) - 1.5 * v - 4 * y - 2 * y * y * y);
      y += 0.001 * v;
    }
  }
  return text;
}

}  // namespace

TEST_CASE("a function inside an equation is named where a prediction uses it beyond what was fitted") {
  std::string const text = R"(
model spring {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter c [N s/m] ~ log_uniform(0.1, 10)
  function f(y) ~ gp(squared_exponential(amplitude = 4 [N], length = 0.6 [m]), zero_at = 0, within = (-2 [m], 2 [m]))
  1 [kg]*y'' + c*y' + f(y) = x
  observe o [m] ~ normal(y, sd = 0.002 [m])
}
data small { file "small.csv"; time t [s]; input x = x [N] hold cubic; measure o = o [m] }
data same  { file "same.csv"; time t [s]; input x = x [N] hold cubic; measure o = o [m] }
data large { file "large.csv"; time t [s]; input x = x [N] hold cubic; measure o = o [m] }
best = fit spring to small with map, seed = 1
near = predict best on same with draws(50), seed = 1
far = predict best on large with draws(50), seed = 1
)";
  CaseRun const run(text, {{"small.csv", pulled(2)}, {"same.csv", pulled(1.9)}, {"large.csv", pulled(5)}});
  json const far = finding_in(run.summary("far"), "far_outside");
  REQUIRE_FALSE(far.is_null());
  CHECK(far.at("names").at(0) == "f");
  CHECK(finding_in(run.summary("near"), "far_outside").is_null());
  CHECK(finding_in(run.summary("far"), "outside_range").is_null());
}
