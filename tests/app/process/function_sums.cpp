// Finite sums in more than the simplest place: several inputs, difference equations, hyper-parameters that are sampled, runs that
// are broken off, trajectories and candidates that leave the range.
#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/running.hpp"
#include "app/tables.hpp"
#include "core/numeric/random.hpp"
#include "gaussian_process/dense.hpp"
#include "relative.hpp"

using namespace sysid;
using json = nlohmann::json;
namespace gp = gaussian_process;

namespace {

json const* finding(json const& summary, std::string const& code) {
  for (json const& each : summary.at("findings"))
    if (each.at("code") == code) return &each;
  return nullptr;
}

/// Rows "x,y" of a curve with noise of sd 0.2.
std::string curve(int count) {
  std::ostringstream rows;
  rows.precision(17);
  rows << "x,y\n";
  Stream stream({7, Purpose::test});
  for (int i = 0; i < count; ++i) {
    double const x = 4 * stream.uniform() - 2;
    rows << x << "," << std::sin(2 * x) + 0.2 * stream.normal() << "\n";
  }
  return rows.str();
}

}  // namespace

TEST_CASE("a finite sum of two inputs is the process that it stands for") {
  std::ostringstream rows;
  rows.precision(17);
  rows << "x,v,y\n";
  Stream stream({6, Purpose::test});
  int const count = 40;
  gp::Observations data{Eigen::MatrixXd(count, 2), Eigen::VectorXd(count), Eigen::MatrixXd(count, 0), {}, {}};
  for (int i = 0; i < count; ++i) {
    double const x = data.inputs(i, 0) = 2 * stream.uniform() - 1, v = data.inputs(i, 1) = 20 * stream.uniform() + 10;
    data.values[i] = x * (v - 20) / 10 + 0.1 * stream.normal();
    rows << x << "," << v << "," << data.values[i] << "\n";
  }
  CaseRun const run(R"(
model surface {
  input x, v
  function f(u, w) ~ gp(squared_exponential(amplitude = 1, length = (0.5, 5)), within = ((-1, 1), (10, 30)), terms = (14, 14))
  observe y ~ normal(f(x, v), sd = 0.1)
}
data points { file "points.csv"; input x = x; input v = v; measure y = y }
best = fit surface to points with map, seed = 1
)",
                    {{"points.csv", rows.str()}});
  auto const covariance = gp::Covariance(*gp::find_kernel("squared_exponential"), {0, 1});
  std::string const table = run.file("best/function_f.csv");
  std::vector<double> const u = column(table, "u"), w = column(table, "w"), mean = column(table, "mean"), sd = column(table, "sd");
  REQUIRE(u.size() >= 21 * 21);
  Eigen::MatrixXd at(static_cast<Eigen::Index>(u.size()), 2);
  at.col(0) = Eigen::Map<Eigen::VectorXd const>(u.data(), at.rows());
  at.col(1) = Eigen::Map<Eigen::VectorXd const>(w.data(), at.rows());
  gp::Prediction const exact = gp::DensePosterior(covariance, data, {1, 0.5, 5, 0.1}).predict({at, Eigen::MatrixXd(at.rows(), 0)});
  for (std::size_t i = 0; i < u.size(); ++i) {
    auto const k = static_cast<Eigen::Index>(i);
    CAPTURE(u[i]);
    CAPTURE(w[i]);
    // At the ends of the range a face of the box is two lengths away: what it reflects is exp(-8) of the variance.
    CHECK(std::fabs(mean[i] - exact.mean[k]) < 1e-3);
    CHECK(std::fabs(sd[i] - std::sqrt(exact.variance[k])) < 1e-3);
  }
}

TEST_CASE("an unknown map in a difference equation is found in free run") {
  CaseRun const run(R"(
model truth {
  time discrete 1 [s]
  input x
  state q
  initial q = 0
  parameter a ~ normal(0, sd = 1)
  q = a*lag(q, 1) - 0.3*lag(q, 1)^3/(1 + lag(q, 1)^2) + lag(x, 1)
  observe y ~ normal(q, sd = 0.02)
}
made = simulate truth with values(a = 0.7), input x = gaussian(sd = 0.7), noise = model, samples = 400, seed = 2, file = "made.csv"
model grey {
  time discrete 1 [s]
  input x
  state q
  initial q = 0
  function f(q) ~ gp(squared_exponential(amplitude = 2, length = 0.8) + linear(slope = 1), zero_at = 0, within = (-3.5, 3.5), terms = 24)
  q = f(lag(q, 1)) + lag(x, 1)
  observe y ~ normal(q, sd = 0.02)
}
data bench { file "results/made/made.csv"; step 1 [s]; input x = x; measure y = y }
best = fit grey to bench with map, prediction = free_run, seed = 1
)",
                    {});
  json const best = run.summary("best");
  CHECK(best.at("fit").at("rmse").get<double>() < 1.1 * 0.02);
  CHECK(finding(best, "outside_range") == nullptr);
  std::string const table = run.file("best/function_f.csv");
  std::vector<double> const q = column(table, "q"), mean = column(table, "mean"), sd = column(table, "sd");
  int looked = 0, inside = 0;
  for (std::size_t i = 0; i < q.size(); ++i) {
    if (std::fabs(q[i]) > 1.5) continue;  // where the record goes
    double const truth = 0.7 * q[i] - 0.3 * std::pow(q[i], 3) / (1 + q[i] * q[i]);
    CHECK(std::fabs(mean[i] - truth) < 0.05);
    ++looked;
    inside += std::fabs(mean[i] - truth) <= 3 * sd[i] + 1e-9 ? 1 : 0;
  }
  REQUIRE(looked > 20);
  CHECK(inside >= 0.9 * looked);
}

TEST_CASE("hyper-parameters that are sampled with the coefficients are those that the process has without them") {
  // Sixteen coordinates that bend with the two hyper-parameters: gradients sample them with a tenth of the simulations of `mh`.
  auto const model = [](std::string const& options, std::string const& backend) {
    return R"(
model curve {
  input x
  parameter s ~ log_normal(median = 1, sd = 0.5)
  parameter l ~ log_normal(median = 1, sd = 0.3)
  function f(u) ~ gp(squared_exponential(amplitude = s, length = l))" +
           options + R"()
  observe y ~ normal(f(x), sd = 0.2)
}
data points { file "points.csv"; input x = x; measure y = y }
posterior = fit curve to points with )" +
           backend + ", seed = 1\n";
  };
  std::string const rows = curve(25);
  CaseRun const summed(model(", within = (-2, 2), terms = 14", "nuts(samples = 4000, burn_in = 1000)"), {{"points.csv", rows}}),
      plain(model("", "mh(samples = 6000, burn_in = 1000)"), {{"points.csv", rows}});
  for (char const* name : {"s", "l"}) {
    CAPTURE(name);
    json const sum = parameter(summed.summary("posterior"), name), process = parameter(plain.summary("posterior"), name);
    double const error = std::hypot(sum.at("mcse_mean").get<double>(), process.at("mcse_mean").get<double>());
    CHECK(error < 0.2 * process.at("sd").get<double>());
    CHECK(std::fabs(sum.at("mean").get<double>() - process.at("mean").get<double>()) < 4 * error);
    CHECK(sum.at("sd").get<double>() == relative(process.at("sd").get<double>(), 0.25));
  }
}

TEST_CASE("an interrupted fit of a finite sum resumes to the bytes of an unbroken one") {
  std::string const text = R"(
model curve {
  input x
  parameter s ~ log_normal(median = 1, sd = 0.5)
  function f(u) ~ gp(squared_exponential(amplitude = s, length = 1), within = (-2, 2), terms = 6)
  observe y ~ normal(f(x), sd = 0.2)
}
data points { file "points.csv"; input x = x; measure y = y }
posterior = fit curve to points with mh(samples = 4000, burn_in = 1000, thin = 10, chains = 2), seed = 1
)";
  TemporaryFolder folder;
  write_file(folder.path() / "points.csv", curve(25));
  auto const run = [&](std::string const& output, std::uint64_t after, bool resume) {
    RunOptions options;
    options.output = folder.path() / output;
    options.interrupt_after = after;
    options.resume = resume;
    int const exit = run_text(folder.path() / "case.sysid", text, options).exit;
    clear_interrupt();
    return exit;
  };
  CHECK(run("whole", 0, false) != 75);
  int interruptions = run("broken", 250, false) == 75 ? 1 : 0;
  interruptions += run("broken", 40, true) == 75 ? 1 : 0;
  CHECK(interruptions == 2);
  CHECK(run("broken", 0, true) != 75);
  for (char const* file : {"summary.json", "draws_1.csv", "draws_2.csv", "function_f.csv"})
    CHECK(read_file(folder.path() / "broken/posterior" / file) == read_file(folder.path() / "whole/posterior" / file));
}

TEST_CASE("a forecast asks all its trajectories, not one of them, whether they leave the range") {
  // Next to nothing is measured of p: in a third of its draws p*x leaves the range, in the middle one it does not.
  CaseRun const run(R"(
model curve {
  input x
  parameter p ~ uniform(0.5, 1.5)
  function f(u) ~ gp(squared_exponential(amplitude = 1, length = 1), within = (-1.2, 1.2), terms = 4)
  observe y ~ normal(f(p*x), sd = 100)
}
data points { file "points.csv"; input x = x; measure y = y }
posterior = fit curve to points with mh(samples = 8000, burn_in = 2000, thin = 10, chains = 2), seed = 1
forecast  = predict posterior on points with draws(100), seed = 1
)",
                    {{"points.csv", "x,y\n-1,0\n-0.5,0\n0,0\n0.5,0\n1,0\n"}});
  json const forecast = run.summary("forecast");
  json const* const said = finding(forecast, "outside_range");
  REQUIRE(said != nullptr);
  std::string const message = said->at("message");
  CAPTURE(message);
  auto const at = message.find("by ");
  REQUIRE(at != std::string::npos);
  int const beyond = std::stoi(message.substr(at + 3));
  CHECK(beyond > 10);
  CHECK(beyond < 60);
  CHECK(message.find("of 100 trajectories") != std::string::npos);
}

TEST_CASE("a selection asks whether its functions can be believed") {
  auto const summary = [](std::string const& range, std::string const& terms) {
    return CaseRun(R"(
model curve {
  input x
  function f(u) ~ gp(squared_exponential(amplitude = 1, length = 1), within = )" +
                       range + ", terms = " + terms + R"()
  observe y ~ normal(f(x), sd = 0.2)
}
model line {
  input x
  parameter a ~ normal(0, sd = 1)
  observe y ~ normal(a*x, sd = 0.2)
}
candidates both { curve; line }
data points { file "points.csv"; input x = x; measure y = y }
choice = select both to points with abc_smc(particles = 200, populations = 4, cross_check = no), seed = 1
forecast = predict choice on points with draws(50), seed = 1
)",
                   {{"points.csv", curve(25)}});
  };
  CaseRun const wide = summary("(-2, 2)", "10"), narrow = summary("(-1, 1)", "10"), few = summary("(-2, 2)", "2");
  CHECK(finding(wide.summary("choice"), "outside_range") == nullptr);
  CHECK(finding(wide.summary("choice"), "basis_inaccurate") == nullptr);
  CHECK(finding(narrow.summary("choice"), "outside_range") != nullptr);
  CHECK(finding(narrow.summary("forecast"), "outside_range") != nullptr);
  CHECK(finding(few.summary("choice"), "basis_inaccurate") != nullptr);
}
