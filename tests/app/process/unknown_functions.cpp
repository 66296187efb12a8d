// Gaussian processes as finite sums: against the processes that they stand for, and inside differential equations.
#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/running.hpp"
#include "app/tables.hpp"
#include "core/numeric/random.hpp"
#include "gaussian_process/dense.hpp"

using namespace sysid;
using json = nlohmann::json;
namespace gp = gaussian_process;

namespace {

double of_parameter(json const& summary, std::string const& name, char const* what) {
  for (auto const& [key, value] : summary.at("parameters").items())
    if (key == name || (value.contains("name") && value.at("name") == name)) return value.at(what);
  FAIL("no parameter " << name);
  return 0;
}
double mean_of(json const& summary, std::string const& name) { return of_parameter(summary, name, "mean"); }
double sd_of(json const& summary, std::string const& name) { return of_parameter(summary, name, "sd"); }

bool says(json const& summary, std::string const& code) {
  for (json const& each : summary.at("findings"))
    if (each.at("code") == code) return true;
  return false;
}

/// 2000 samples of the displacement of an oscillator with a hardening spring.
std::string hardening() {
  TemporaryFolder folder;
  RunOptions options;
  options.output = folder.path() / "results";
  run_text(folder.path() / "truth.sysid", R"(
model truth {
  input   x [N]
  state   y [m]
  initial y = 0, y' = 0
  parameter c [N s/m] ~ log_uniform(1, 100)
  1 [kg]*y'' + c*y' + 1e4 [N/m]*y + 5e9 [N/m^3]*y^3 = x
  observe displacement [m] ~ normal(y, sd = 2e-5 [m])
}
made = simulate truth with values(c = 20), input x = gaussian(sd = 10), noise = model, samples = 2000, rate = 1000 [Hz],
    seed = 3, file = "made.csv"
)",
           options, {"simulate"});
  return read_file(options.output / "made/made.csv");
}

constexpr char bench[] = R"(
data bench {
  file    "made.csv"
  time    t [s]
  input   x = x [N] hold zero_order
  measure displacement = displacement [m]
  split   train = rows 1..1000, test = rows 1001..2000
}
best = fit grey to bench.train with map, seed = 1
)";

constexpr char unknown_spring[] = R"(
model grey {
  input   x [N]
  state   y [m]
  initial y = 0, y' = 0
  parameter c     [N s/m] ~ log_uniform(2, 200)
  parameter k     [N/m]   ~ log_uniform(1e3, 1e5)
  parameter sigma [m]     ~ log_uniform(1e-7, 1e-3)
  function f(y) ~ gp(squared_exponential(amplitude = 50 [N], length = 1.5e-3 [m]), zero_at = 0, flat_at = 0,
      within = (-2e-3, 2e-3), terms = 12)
  1 [kg]*y'' + c*y' + k*y + f(y) = x
  observe displacement ~ normal(y, sd = sigma)
}
)";

}  // namespace

TEST_CASE("a finite sum is the process that it stands for, conditions included") {
  std::ostringstream rows;
  rows.precision(17);
  rows << "x,y\n";
  Stream stream({5, Purpose::test});
  int const count = 15;
  gp::Observations data{Eigen::MatrixXd(count, 1), Eigen::VectorXd(count), Eigen::MatrixXd(count, 0), {}, {}};
  for (int i = 0; i < count; ++i) {
    data.inputs(i, 0) = 4 * stream.uniform() - 2;
    data.values[i] = std::pow(data.inputs(i, 0), 3) / 3 + 0.2 * stream.normal();
    rows << data.inputs(i, 0) << "," << data.values[i] << "\n";
  }
  CaseRun const run(R"(
model curve {
  input x
  function f(u) ~ gp(squared_exponential(amplitude = 2, length = 1) + linear(slope = 0.5), zero_at = 0, flat_at = 0,
      within = (-2, 2), terms = 24)
  observe y ~ normal(f(x), sd = 0.2)
}
data points { file "points.csv"; input x = x; measure y = y }
best = fit curve to points with map, seed = 1
)",
                    {{"points.csv", rows.str()}});
  auto const covariance =
      (gp::Covariance(*gp::find_kernel("squared_exponential"), {0}) + gp::Covariance(*gp::find_kernel("linear"), {0}))
          .conditioned({{{0}, -1}, {{0}, 0}});
  std::string const table = run.file("best/function_f.csv");
  std::vector<double> const place = column(table, "u"), mean = column(table, "mean"), sd = column(table, "sd");
  REQUIRE(place.size() == 101);
  Eigen::MatrixXd const at = Eigen::Map<Eigen::VectorXd const>(place.data(), 101);
  gp::Prediction const exact = gp::DensePosterior(covariance, data, {2, 1, 0.5, 0.2}).predict({at, Eigen::MatrixXd(101, 0)});
  for (std::size_t i = 0; i < 101; ++i) {
    auto const k = static_cast<Eigen::Index>(i);
    CAPTURE(place[i]);
    double const width = std::sqrt(exact.variance[k]);
    // At the ends of the range a face of the box is two lengths away: what it reflects is exp(-8) of the variance.
    CHECK(std::fabs(mean[i] - exact.mean[k]) < 1e-3);
    CHECK(std::fabs(sd[i] - width) < 1e-3);
  }
  CHECK(std::fabs(mean[50]) < 1e-9);
  CHECK(sd[50] < 1e-9);
  CHECK(!says(run.summary("best"), "basis_inaccurate"));
}

TEST_CASE("an unknown spring force inside an equation of motion is found, and its slope at rest is the stiffness") {
  CaseRun const run(std::string(unknown_spring) + bench + "forecast = predict best on bench.test with draws(1), seed = 1\n",
                    {{"made.csv", hardening()}});
  json const best = run.summary("best");
  CHECK(std::fabs(mean_of(best, "c") - 20) < 4 * sd_of(best, "c"));
  CHECK(std::fabs(mean_of(best, "k") - 1e4) < 4 * sd_of(best, "k"));
  CHECK(sd_of(best, "k") < 200);
  CHECK(std::fabs(mean_of(best, "sigma") - 2e-5) < 4 * sd_of(best, "sigma"));
  // The cubic force where the record goes, within the band's width.
  std::string const table = run.file("best/function_f.csv");
  std::vector<double> const y = column(table, "y"), mean = column(table, "mean"), sd = column(table, "sd");
  std::vector<double> const record = column(read_file(run.folder.path() / "made.csv"), "displacement");
  double reach = 0;
  for (std::size_t i = 0; i < 1000; ++i) reach = std::max(reach, std::fabs(record[i]));
  CHECK(run.file("best/figures/function_f.gnuplot").find("$visits0") != std::string::npos);
  CHECK(reach > 1e-3);
  int inside = 0, looked = 0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    if (std::fabs(y[i]) > 0.9 * reach) continue;
    double const truth = 5e9 * std::pow(y[i], 3);
    CHECK(std::fabs(mean[i] - truth) < 0.25);  // of forces up to 10 N
    ++looked;
    inside += std::fabs(mean[i] - truth) <= 3 * sd[i] + 1e-9 ? 1 : 0;
  }
  CHECK(inside >= 0.9 * looked);
  double const rmse = run.summary("forecast").at("fit").at("rmse");
  CHECK(rmse < 1.1 * 2e-5);
}

TEST_CASE("conditions that others imply take nothing away") {
  auto const found = [](std::string const& conditions) {
    CaseRun const run(R"(
model curve {
  input x
  function f(u) ~ gp(squared_exponential(amplitude = 2, length = 1) + linear(slope = 0.5), )" +
                          conditions + R"(,
      within = (-2, 2), terms = 12)
  observe y ~ normal(f(x), sd = 0.2)
}
data points { file "points.csv"; input x = x; measure y = y }
best = fit curve to points with map, seed = 1
)",
                      {{"points.csv", "x,y\n-2,-2.5\n-1,-0.5\n0.5,0.1\n1,0.4\n1.5,1\n2,2.6\n"}});
    return column(run.file("best/function_f.csv"), "mean");
  };
  std::vector<double> const once = found("zero_at = (0, 1)"), twice = found("zero_at = (0, 1, 0, 1)");
  REQUIRE(once.size() == twice.size());
  for (std::size_t i = 0; i < once.size(); ++i) CHECK(std::fabs(once[i] - twice[i]) < 1e-8);
}

TEST_CASE("a range that the motion leaves, and too few terms, are said") {
  std::string const model = unknown_spring;
  std::string const record = hardening();
  auto const found = [&](std::string const& range, std::string const& terms) {
    return CaseRun(with(with(model, "(-2e-3, 2e-3)", range), "terms = 12", terms) + bench, {{"made.csv", record}}).summary("best");
  };
  json const enough = found("(-2e-3, 2e-3)", "terms = 12"), few = found("(-2e-3, 2e-3)", "terms = 3"),
             narrow = found("(-8e-4, 8e-4)", "terms = 12");
  CHECK(!says(enough, "outside_range"));
  CHECK(!says(enough, "basis_inaccurate"));
  CHECK(says(few, "basis_inaccurate"));
  CHECK(!says(few, "outside_range"));
  CHECK(says(narrow, "outside_range"));
}
