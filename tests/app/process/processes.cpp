// Fits and predictions with Gaussian processes end to end: against quadrature, closed forms, and what must be said.
#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/running.hpp"
#include "app/tables.hpp"
#include "core/numeric/random.hpp"
#include "gaussian_process/dense.hpp"
#include "gaussian_process/regression.hpp"

using namespace sysid;
using json = nlohmann::json;
namespace gp = gaussian_process;

namespace {

/// The record of the Stan project's example (posteriordb, gp_pois_regr, BSD-3-Clause).
double const x[] = {-10, -8, -6, -4, -2, 0, 2, 4, 6, 8, 10};
double const y[] = {4.75906, 1.59423, 2.99548, 5.27501, 1.66472, 2.24347, 2.8914, 4.08681, 4.60588, 0.802364, 3.92136};

std::string points() {
  std::ostringstream text;
  text.precision(17);
  text << "x,y\n";
  for (int i = 0; i < 11; ++i) text << x[i] << "," << y[i] << "\n";
  return text.str();
}

gp::Observations observations() {
  gp::Observations o{Eigen::MatrixXd(11, 1), Eigen::VectorXd(11), Eigen::MatrixXd(11, 0), {}, {}};
  for (int i = 0; i < 11; ++i) o.inputs(i, 0) = x[i], o.values[i] = y[i];
  return o;
}

bool says(json const& summary, std::string const& code) {
  for (json const& each : summary.at("findings"))
    if (each.at("code") == code) return true;
  return false;
}

}  // namespace

TEST_CASE("a process at samples is drawn as a function over what the samples reach, as regression has it") {
  CaseRun const run(R"(
model toy {
  input x
  parameter rho = 6
  parameter alpha = 2
  parameter sigma ~ log_uniform(0.99, 1.01)
  function f(u) ~ gp(squared_exponential(amplitude = alpha, length = rho))
  observe y ~ normal(f(x), sd = sigma)
}
data points { file "points.csv"; input x = x; measure y = y }
best = fit toy to points with map, seed = 1
)",
                    {{"points.csv", points()}});
  std::string const table = run.file("best/function_f.csv");
  std::vector<double> const places = column(table, "u"), mean = column(table, "mean"), sd = column(table, "sd");
  REQUIRE(places.size() == 61);
  CHECK(places.front() == -10);
  CHECK(places.back() == 10);
  gp::Covariance const covariance(*gp::find_kernel("squared_exponential"), {0});
  double const sigma = parameter(run.summary("best"), "sigma").at("mean").get<double>();
  std::vector<double> const hyper_parameters = {2, 6, sigma};
  gp::Places at{Eigen::MatrixXd(61, 1), Eigen::MatrixXd(61, 0)};
  for (int i = 0; i < 61; ++i) at.inputs(i, 0) = places[static_cast<std::size_t>(i)];
  auto const exact = gp::conditional(covariance, observations(), hyper_parameters, at).prediction;
  for (int i = 0; i < 61; ++i) {
    CHECK(mean[static_cast<std::size_t>(i)] == doctest::Approx(exact.mean[i]).epsilon(1e-9));
    CHECK(sd[static_cast<std::size_t>(i)] == doctest::Approx(std::sqrt(exact.variance[i])).epsilon(1e-7));
  }
  std::string const script = run.file("best/figures/function_f.gnuplot");
  CHECK(script.find("$visits0") != std::string::npos);
}

TEST_CASE("chains over hyper-parameters agree with quadrature") {
  CaseRun const run(R"(
model toy {
  input x
  parameter rho ~ gamma(shape = 25, rate = 4)
  parameter alpha ~ half_normal(sd = 2)
  parameter sigma ~ half_normal(sd = 1)
  function f(u) ~ gp(squared_exponential(amplitude = alpha, length = rho))
  observe y ~ normal(f(x), variance = sigma)
}
data points { file "points.csv"; input x = x; measure y = y }
posterior = fit toy to points with mh(samples = 20000, burn_in = 4000, thin = 4, chains = 4), seed = 1
)",
                    {{"points.csv", points()}});
  json const summary = run.summary("posterior");
  // The means by the midpoint rule on a box that holds all but 1e-5 of the prior.
  gp::Covariance const covariance(*gp::find_kernel("squared_exponential"), {0});
  gp::Observations const data = observations();
  double sum = 0, means[3] = {0, 0, 0}, squares[3] = {0, 0, 0};
  constexpr int steps = 48;
  for (int i = 0; i < steps; ++i)
    for (int j = 0; j < steps; ++j)
      for (int k = 0; k < steps; ++k) {
        double const at[] = {1.5 + 12.5 * (i + 0.5) / steps, 9 * (j + 0.5) / steps, 5.5 * (k + 0.5) / steps};
        std::vector<double> const parameters = {at[1], at[0], std::sqrt(at[2])};
        double const likelihood = gp::dense_marginal(covariance, data, parameters, false).log_likelihood;
        double const prior = 24 * std::log(at[0]) - 4 * at[0] - at[1] * at[1] / 8 - at[2] * at[2] / 2;
        double const weight = std::exp(likelihood + prior);
        sum += weight;
        for (int p = 0; p < 3; ++p) means[p] += weight * at[p], squares[p] += weight * at[p] * at[p];
      }
  char const* const names[] = {"rho", "alpha", "sigma"};
  for (int p = 0; p < 3; ++p) {
    CAPTURE(names[p]);
    json const found = parameter(summary, names[p]);
    double const mean = means[p] / sum, sd = std::sqrt(squares[p] / sum - mean * mean);
    CHECK(found.at("rhat").get<double>() < 1.01);
    CHECK(std::fabs(found.at("mean").get<double>() - mean) < 4 * found.at("mcse_mean").get<double>() + 0.005 * sd);
    CHECK(found.at("sd").get<double>() == doctest::Approx(sd).epsilon(0.05));
  }
}

TEST_CASE("with known hyper-parameters coefficients and predictions are the closed form") {
  std::string const model = R"(
model line {
  input x
  parameter a ~ normal(0, sd = 10)
  parameter b ~ normal(1, sd = 2)
  function f(u) ~ gp(squared_exponential(amplitude = 2, length = 3))
  observe y ~ normal(a + b*x + f(x), sd = 0.5)
  derive twice = 2*b
}
)";
  CaseRun const run(model + R"(
data points { file "points.csv"; input x = x; measure y = y }
best = fit line to points with map, seed = 1
ahead = predict best on points with draws(2000), seed = 1
)",
                    {{"points.csv", points()}});
  gp::Observations data = observations();
  data.columns = Eigen::MatrixXd(11, 2);
  data.columns << Eigen::VectorXd::Ones(11), data.inputs.col(0);
  data.prior_mean = Eigen::Vector2d(0, 1);
  data.prior_sd = Eigen::Vector2d(10, 2);
  gp::DensePosterior const exact(gp::Covariance(*gp::find_kernel("squared_exponential"), {0}), data, {2, 3, 0.5});
  gp::Coefficients const coefficients = exact.coefficients();
  json const summary = run.summary("best");
  char const* const names[] = {"a", "b"};
  for (int p = 0; p < 2; ++p) {
    json const found = parameter(summary, names[p]);
    double const sd = std::sqrt(coefficients.covariance(p, p));
    CHECK(std::fabs(found.at("mean").get<double>() - coefficients.mean[p]) < 1e-4 * sd);
    CHECK(std::fabs(found.at("sd").get<double>() - sd) < 1e-4 * sd);
  }
  double const twice = parameter(summary, "twice").at("mean").get<double>();
  CHECK(std::fabs(twice - 2 * coefficients.mean[1]) < 1e-4 * std::sqrt(coefficients.covariance(1, 1)));
  // 2000 functions: their mean is the conditional mean to a few hundredths of their width.
  gp::Prediction const conditional =
      gp::DensePosterior(gp::Covariance(*gp::find_kernel("squared_exponential"), {0}),
                         {data.inputs, data.values - data.columns * coefficients.mean, Eigen::MatrixXd(11, 0), {}, {}}, {2, 3, 0.5})
          .predict({data.inputs, Eigen::MatrixXd(11, 0)});
  std::vector<double> const mean = column(run.file("ahead/predict.csv"), "y_mean");
  REQUIRE(mean.size() == 11);
  for (int i = 0; i < 11; ++i) {
    double const expected = conditional.mean[i] + coefficients.mean[0] + coefficients.mean[1] * x[i];
    CHECK(std::fabs(mean[static_cast<std::size_t>(i)] - expected) < 4 * std::sqrt(conditional.variance[i] / 2000));
  }
}

TEST_CASE("what is integrated out beside a sampled parameter is the closed form at its optimum, and failures are said") {
  CaseRun const run(R"(
model line {
  input x
  parameter a ~ normal(0, sd = 10)
  parameter b ~ normal(1, sd = 2)
  parameter s ~ normal(0, sd = 3)
  function f(u) ~ gp(squared_exponential(amplitude = s, length = 3))
  observe y ~ normal(a + b*x + f(x), sd = 0.5)
}
data points { file "points.csv"; input x = x; measure y = y }
best = fit line to points with map, seed = 1
chains = fit line to points with mh(samples = 1000, burn_in = 500, thin = 1, chains = 2), seed = 1
)",
                    {{"points.csv", points()}});
  json const summary = run.summary("best");
  gp::Observations data = observations();
  data.columns = Eigen::MatrixXd(11, 2);
  data.columns << Eigen::VectorXd::Ones(11), data.inputs.col(0);
  data.prior_mean = Eigen::Vector2d(0, 1);
  data.prior_sd = Eigen::Vector2d(10, 2);
  double const s = parameter(summary, "s").at("mean").get<double>();
  gp::Coefficients const coefficients =
      gp::DensePosterior(gp::Covariance(*gp::find_kernel("squared_exponential"), {0}), data, {s, 3, 0.5}).coefficients();
  CHECK(parameter(summary, "a").at("mean").get<double>() == doctest::Approx(coefficients.mean[0]).epsilon(1e-8));
  CHECK(parameter(summary, "b").at("mean").get<double>() == doctest::Approx(coefficients.mean[1]).epsilon(1e-8).scale(0));
  CHECK(parameter(summary, "b").at("sd").get<double>() ==
        doctest::Approx(std::sqrt(coefficients.covariance(1, 1))).epsilon(1e-8).scale(0));
  // A chain meets the half of the prior where an amplitude is none.
  CHECK(says(run.summary("chains"), "failed_solves"));
}

TEST_CASE("a free run of a process that is known feeds its values back") {
  // y_t = 0.8 y_(t-1) + u: a process with a linear kernel learns it, and runs free on another input without losing it.
  Stream stream(StreamKey{.seed = 6});
  std::ostringstream rows;
  rows.precision(17);
  rows << "u,y\n";
  double value = 0;
  std::vector<double> clean;
  for (int i = 0; i < 240; ++i) {
    double const u = stream.normal();
    value = 0.8 * value + u;
    clean.push_back(value);
    rows << u << "," << value + 1e-3 * stream.normal() << "\n";
  }
  CaseRun const run(R"(
model echo {
  time discrete 1 [s]
  input u
  function f(now, before) ~ gp(linear(slope = (1, 1)))
  parameter sigma ~ log_uniform(1e-4, 1)
  observe y ~ normal(f(u, lag(measured(y), 1)), sd = sigma)
}
data record { file "rows.csv"; step 1 [s]; input u = u; measure y = y; split train = rows 1..120, test = rows 121..240 }
best = fit echo to record.train with map, seed = 1
free = predict best on record.test with draws(40), prediction = free_run, seed = 1
)",
                    {{"rows.csv", rows.str()}});
  std::vector<double> const mean = column(run.file("free/predict.csv"), "y_mean");
  double worst = 0;
  for (std::size_t i = 0; i < mean.size(); ++i) worst = std::max(worst, std::fabs(mean[i] - clean[clean.size() - mean.size() + i]));
  CHECK(mean.size() >= 120);
  CHECK(worst < 0.01);  // a value that is not fed back would be off by the size of y
}

TEST_CASE("inputs outside, repeated inputs and lengths beyond the data are named") {
  std::ostringstream rows;
  rows.precision(17);
  rows << "u,v,y\n";
  Stream stream(StreamKey{.seed = 2});
  for (int i = 0; i < 60; ++i) {
    double const u = i < 40 ? std::floor(10 * stream.uniform()) / 10 : 2 + 0.01 * i, v = stream.uniform();
    rows << u << "," << v << "," << std::sin(3 * u) + 0.05 * stream.normal() << "\n";
  }
  CaseRun const run(R"(
model curve {
  input u, v
  parameter l ~ log_normal(median = 0.5, sd = 0.5)
  parameter sigma ~ log_uniform(0.01, 1)
  function f(a) ~ gp(matern52(amplitude = 1, length = l))
  function g(b) ~ gp(matern52(amplitude = 0.1, length = 50))
  observe y ~ normal(f(u) + g(v), sd = sigma)
}
data record { file "rows.csv"; input u = u; input v = v; measure y = y; split train = rows 1..40, test = rows 41..60 }
best = fit curve to record.train with map, seed = 1
out = predict best on record.test with draws(50), seed = 1
again = predict best on record.train with draws(50), seed = 1
)",
                    {{"rows.csv", rows.str()}});
  json const best = run.summary("best");
  CHECK(says(best, "length_beyond_range"));
  CHECK(says(run.summary("out"), "far_outside"));
  CHECK(!says(run.summary("again"), "far_outside"));
}

TEST_CASE("an input that was the same at all fitted samples has no range, and no number of its widths is stated") {
  std::string rows = "u,v,y\n";
  for (int i = 0; i < 20; ++i)
    rows += std::to_string(0.1 * (i % 10)) + (i < 10 ? ",1," : ",2,") + std::to_string(std::sin(0.3 * (i % 10))) + "\n";
  CaseRun const run(R"(
model curve {
  input u, v
  parameter l ~ log_normal(median = 0.5, sd = 0.5)
  function f(a, b) ~ gp(squared_exponential(amplitude = 1, length = (l, 1)))
  observe y ~ normal(f(u, v), sd = 0.1)
}
data record { file "rows.csv"; input u = u; input v = v; measure y = y; split train = rows 1..10, test = rows 11..20 }
best = fit curve to record.train with map, seed = 1
out = predict best on record.test with draws(20), seed = 1
)",
                    {{"rows.csv", rows}});
  bool found = false;
  json const out = run.summary("out");
  for (json const& finding : out.at("findings")) {
    if (finding.at("code") != "far_outside") continue;
    found = true;
    CHECK(finding.at("message") == "the input `b` of `f` differs from the one value that it had at all fitted samples");
  }
  CHECK(found);
}

TEST_CASE("samples with the same inputs are counted") {
  CaseRun const run(R"(
model curve {
  input u
  parameter l ~ log_normal(median = 0.5, sd = 0.5)
  function f(a) ~ gp(matern52(amplitude = 1, length = l))
  observe y ~ normal(f(u), sd = 0.1)
}
data record { file "rows.csv"; input u = u; measure y = y }
best = fit curve to record with map, seed = 1
)",
                    {{"rows.csv", "u,y\n0,0\n0.1,0.2\n0.1,0.25\n0.5,0.4\n0.5,0.3\n0.5,0.35\n1,0.1\n"}});
  json const summary = run.summary("best");
  REQUIRE(says(summary, "duplicate_inputs"));
  CHECK(run.result.out.find("3 of 7 samples") != std::string::npos);
}
