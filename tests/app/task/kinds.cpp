// Regression and autoregression end to end against their closed forms; what the reports and made records say of dynamics.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/running.hpp"
#include "core/numeric/random.hpp"
#include "linear_algebra/decompositions.hpp"

using namespace sysid;
using json = nlohmann::json;

namespace {

/// Posterior of a linear model with normal priors N(0, prior_sd^2) and noise sd: mean and covariance.
struct Posterior {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};
Posterior closed_form(Eigen::MatrixXd const& regressors, Eigen::VectorXd const& y, double sd, double prior_sd) {
  Eigen::MatrixXd const precision = regressors.transpose() * regressors / (sd * sd) +
                                    Eigen::MatrixXd::Identity(regressors.cols(), regressors.cols()) / (prior_sd * prior_sd);
  return {solve_symmetric(precision, regressors.transpose() * y / (sd * sd)), inverse(precision)};
}

}  // namespace

TEST_CASE("the posterior of a linear regression is the closed form, whatever the order of the rows") {
  constexpr int n = 40;
  Stream stream(StreamKey{.seed = 4});
  Eigen::MatrixXd regressors(n, 3);
  Eigen::VectorXd y(n);
  std::string rows;
  for (int i = 0; i < n; ++i) {
    double const T = 20 * stream.uniform() - 5, q = stream.normal();
    regressors.row(i) << 1, T, q;
    y(i) = 2 - 0.3 * T + 5 * q + 0.8 * stream.normal();
    std::ostringstream line;
    line.precision(17);
    line << T << "," << q << "," << y(i) << "\n";
    rows = line.str() + rows;  // the last first
  }
  CaseRun const run(R"(
model line {
  input T [degC], q
  parameter a [mm] ~ normal(0, sd = 10)
  parameter b [mm/degC] ~ normal(0, sd = 10)
  parameter c [mm] ~ normal(0, sd = 10)
  observe deflection ~ normal(a + b*T + c*q, sd = 0.8)
}
data rows { file "rows.csv"; input T = T [degC]; input q = q; measure deflection = y [mm] }
best = fit line to rows with map, seed = 1
)",
                    {{"rows.csv", "T,q,y\n" + rows}});
  Posterior const exact = closed_form(regressors, y, 0.8, 10);
  json const summary = run.summary("best");
  char const* const names[] = {"a", "b", "c"};
  for (int p = 0; p < 3; ++p) {
    json const found = parameter(summary, names[p]);
    double const sd = std::sqrt(exact.covariance(p, p));
    CAPTURE(names[p]);
    CHECK(std::fabs(found.at("mean").get<double>() - exact.mean(p)) < 1e-4 * sd);
  }
  // The header of predictions counts rows, and residuals in no order are not tested for order.
  CHECK(run.file("best/predict.csv").find("\nrow,") != std::string::npos);
  CHECK(run.result.out.find("whiteness") == std::string::npos);
}

TEST_CASE("the posterior of an autoregression is least squares on lagged samples") {
  constexpr int n = 120;
  Stream stream(StreamKey{.seed = 9});
  std::vector<double> y;
  std::ostringstream rows;
  rows.precision(17);
  for (int i = 0; i < n; ++i) {
    double const one = i > 0 ? y[static_cast<std::size_t>(i) - 1] : 0, two = i > 1 ? y[static_cast<std::size_t>(i) - 2] : 0;
    y.push_back(1.4 * one - 0.7 * two + 0.5 * stream.normal());
    rows << y.back() << "\n";
  }
  Eigen::MatrixXd regressors(n - 2, 2);
  Eigen::VectorXd now(n - 2);
  for (int i = 2; i < n; ++i) {
    regressors.row(i - 2) << y[static_cast<std::size_t>(i) - 1], y[static_cast<std::size_t>(i) - 2];
    now(i - 2) = y[static_cast<std::size_t>(i)];
  }
  CaseRun const run(R"(
model ar {
  time discrete 0.5 [s]
  state y
  initial y = measured(output)
  parameter a1 ~ normal(0, sd = 5)
  parameter a2 ~ normal(0, sd = 5)
  y = a1*lag(y, 1) + a2*lag(y, 2)
  observe output ~ normal(y, sd = 0.5)
}
data record { file "record.csv"; measure output = y }
best = fit ar to record with map, prediction = one_step, seed = 1
)",
                    {{"record.csv", "y\n" + rows.str()}});
  Posterior const exact = closed_form(regressors, now, 0.5, 5);
  json const summary = run.summary("best");
  char const* const names[] = {"a1", "a2"};
  for (int p = 0; p < 2; ++p)
    CHECK(std::fabs(parameter(summary, names[p]).at("mean").get<double>() - exact.mean(p)) <
          1e-4 * std::sqrt(exact.covariance(p, p)));
  CHECK(summary.dump().find("one_step: from measured samples, one step ahead") != std::string::npos);
  CHECK(summary.dump().find("the first 2 rows are not scored: the model uses them only as past samples") != std::string::npos);
  CHECK(run.file("best/resolved.sysid").find("prediction = one_step") != std::string::npos);
}

TEST_CASE("a made record of a model with measured lags feeds its noise back, in percent it does not") {
  std::string const model = R"(
model ar {
  time discrete 0.1 [s]
  parameter a ~ uniform(-1, 1)
  observe output ~ normal(1 + a*lag(measured(output), 1), sd = 0.3)
}
)";
  auto const column = [](std::string const& csv, int wanted) {
    std::vector<double> values;
    std::istringstream lines(csv);
    for (std::string line; std::getline(lines, line);) {
      if (line.empty() || (line[0] != '-' && (line[0] < '0' || line[0] > '9'))) continue;
      std::istringstream cells(line);
      std::string cell;
      for (int k = 0; k <= wanted; ++k) std::getline(cells, cell, ',');
      values.push_back(std::stod(cell));
    }
    return values;
  };
  CaseRun const run(model + "made = simulate ar with values(a = 0.9), samples = 50, seed = 3\n" +
                        "clean = simulate ar with values(a = 0.9), noise = 0 [percent], samples = 50, seed = 3\n",
                    {});
  std::vector<double> const noisy = column(run.file("made/made.csv"), 1), centre = column(run.file("made/made.csv"), 2);
  std::vector<double> const free = column(run.file("clean/clean.csv"), 1);
  REQUIRE(noisy.size() == 50);
  CHECK(centre[0] == 1);
  double expected = 0;
  for (std::size_t i = 1; i < 50; ++i) {
    CHECK(centre[i] == doctest::Approx(1 + 0.9 * noisy[i - 1]).epsilon(1e-14));
    CHECK(free[i - 1] == doctest::Approx(1 + 0.9 * expected).epsilon(1e-14));
    expected = free[i - 1];
  }
}

TEST_CASE("a gap in a lagged channel costs the rows that read it, in the fit and in predictions") {
  std::string rows = "y\n";
  for (int i = 0; i < 60; ++i) rows += i == 20 ? "NA\n" : std::to_string(std::sin(0.5 * i) + 0.1 * std::cos(7.0 * i)) + "\n";
  CaseRun const run(R"(
model ar {
  time discrete 0.1 [s]
  parameter a1 ~ normal(0, sd = 5)
  parameter a2 ~ normal(0, sd = 5)
  observe output ~ normal(a1*lag(measured(output), 1) + a2*lag(measured(output), 2), sd = 0.1)
}
data record { file "record.csv"; measure output = y }
posterior = fit ar to record with mh(samples = 600, burn_in = 300, thin = 3), seed = 1
again = predict posterior on record with draws(50), seed = 1
)",
                    {{"record.csv", rows}});
  CHECK(run.summary("posterior").dump().find("output: 2 rows are not scored, because a past sample is missing") != std::string::npos);
  for (std::string const task : {"posterior", "again"}) {
    std::string const scores = run.summary(task).at("fit").dump();
    CAPTURE(scores);
    CHECK(scores.find("rmse") != std::string::npos);
    CHECK(scores.find("null") == std::string::npos);
  }
}
