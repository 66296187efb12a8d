// The evidence of a fit against closed forms and quadrature, for every kind of likelihood, and what stands where there is none.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "app/running.hpp"
#include "core/numeric/random.hpp"
#include "linear_algebra/decompositions.hpp"

using namespace sysid;
using json = nlohmann::json;

namespace {

/// Columns t, x, y of 30 rows: noise about 1 + 0.5 x.
struct Points {
  Eigen::VectorXd t, x, y;
  std::string csv = "t,x,y\n";

  explicit Points(int rows = 30) : t(rows), x(rows), y(rows) {
    Stream stream({.seed = 5, .purpose = Purpose::test, .index = 0, .step = 0});
    std::ostringstream text;
    text.precision(17);
    for (int i = 0; i < rows; ++i) {
      t[i] = 0.5 * i, x[i] = stream.normal(), y[i] = 1 + 0.5 * x[i] + 0.7 * stream.normal();
      text << t[i] << "," << x[i] << "," << y[i] << "\n";
    }
    csv += text.str();
  }
};

/// log N(y | 0, covariance).
double log_normal(Eigen::VectorXd const& y, Eigen::MatrixXd const& covariance) {
  Eigen::MatrixXd const factor = *cholesky(covariance);
  double const log_root = factor.diagonal().array().log().sum();
  return -0.5 * y.dot(solve_cholesky(factor, y).col(0)) - log_root -
         0.5 * static_cast<double>(y.size()) * std::log(2 * std::numbers::pi);
}

/// Of y = columns * w + noise of `sd`, w normal about 0 with `prior_sd`.
double linear_evidence(Eigen::VectorXd const& y, Eigen::MatrixXd const& columns, double prior_sd, double sd) {
  return log_normal(y,
                    prior_sd * prior_sd * columns * columns.transpose() + sd * sd * Eigen::MatrixXd::Identity(y.size(), y.size()));
}

json evidence(std::string const& text, std::string const& csv, std::string const& task = "posterior") {
  CaseRun const run(text, {{"points.csv", csv}});
  return run.summary(task).at("evidence");
}

double log_evidence(std::string const& text, std::string const& csv) {
  json const found = evidence(text, csv);
  CAPTURE(found.dump());
  REQUIRE(found.at("log_evidence").is_number());
  CHECK_FALSE(found.contains("not_confirmed"));
  return found.at("log_evidence").get<double>();
}

std::string const line = R"(
model line {
  input x
  parameter a [mm] ~ normal(0, sd = 2)
  parameter b [mm] ~ normal(0, sd = 2)
  observe y [mm] ~ normal(a + b*x, sd = 0.7)
}
data points { file "points.csv"; input x = x; measure y = y [mm] }
posterior = fit line to points with map, seed = 1
)";

}  // namespace

TEST_CASE("the evidence of a regression with normal priors and known noise is the closed form, by map and by mh") {
  Points const points;
  Eigen::MatrixXd columns(30, 2);
  columns << Eigen::VectorXd::Ones(30), points.x;
  double const exact = linear_evidence(points.y, columns, 2, 0.7);
  CHECK(log_evidence(line, points.csv) == doctest::Approx(exact).epsilon(1e-7));
  CHECK(log_evidence(with(line, "map", "mh(samples = 400, burn_in = 200, thin = 1)"), points.csv) ==
        doctest::Approx(exact).epsilon(1e-7));
}

TEST_CASE("a fit computes its evidence as it is asked to, or not at all") {
  Points const points;
  Eigen::MatrixXd columns(30, 2);
  columns << Eigen::VectorXd::Ones(30), points.x;
  double const exact = linear_evidence(points.y, columns, 2, 0.7);
  std::string const chains = with(line, "map", "mh(samples = 2000, burn_in = 500, thin = 1)");
  for (std::string const method : {"importance", "bridge", "smc", "laplace", "none"}) {
    CAPTURE(method);
    json const found = evidence(with(chains, ", seed = 1", ", evidence = " + method + ", seed = 1"), points.csv);
    CAPTURE(found.dump());
    if (method == "none") {
      CHECK(found.at("log_evidence").is_null());
      continue;
    }
    CHECK(found.at("method") == method);
    double const error = method == "laplace" ? 0 : found.at("standard_error").get<double>();
    CHECK(std::fabs(found.at("log_evidence").get<double>() - exact) < 4 * error + 1e-6);
    CHECK(found.at("laplace").get<double>() == doctest::Approx(exact).epsilon(1e-7));
  }
  CaseRun const run(with(chains, ", seed = 1", ", evidence = bridge, seed = 1"), {{"points.csv", points.csv}});
  CHECK(run.result.out.find("(bridge sampling)") != std::string::npos);
}

TEST_CASE("the evidence of a record in another unit is that of its density there") {
  Points const points;
  std::string const in_metres =
      with(with(with(line, "parameter a [mm] ~ normal(0, sd = 2)", "parameter a [m] ~ normal(0, sd = 2e-3)"),
                "parameter b [mm] ~ normal(0, sd = 2)", "parameter b [m] ~ normal(0, sd = 2e-3)"),
           "observe y [mm] ~ normal(a + b*x, sd = 0.7)", "observe y [m] ~ normal(a + b*x, sd = 0.7e-3)");
  CHECK(log_evidence(in_metres, points.csv) == doctest::Approx(log_evidence(line, points.csv) + 30 * std::log(1000)).epsilon(1e-7));
}

TEST_CASE("the evidence of a differential equation that is linear in its parameters is the closed form") {
  Points const points;
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(30, 2);
  for (int i = 1; i < 30; ++i) {
    columns(i, 0) = columns(i - 1, 0) + 0.5;
    columns(i, 1) = columns(i - 1, 1) + 0.5 * points.x[i - 1];
  }
  std::string const text = R"(
model drift {
  input x
  state level
  initial level = 0
  parameter a ~ normal(0, sd = 2)
  parameter b ~ normal(0, sd = 2)
  level' = a + b*x
  observe y ~ normal(level, sd = 0.7)
}
data points { file "points.csv"; time t [s]; input x = x hold zero_order; measure y = y }
posterior = fit drift to points with map, seed = 1
)";
  CHECK(log_evidence(text, points.csv) == doctest::Approx(linear_evidence(points.y, columns, 2, 0.7)).epsilon(1e-7));
}

TEST_CASE("the evidence of an autoregression is the closed form given the samples that it looks back to") {
  Points const points;
  Eigen::MatrixXd columns(29, 2);
  columns << points.y.head(29), points.x.tail(29);
  std::string const text = R"(
model arx {
  time discrete 0.5 [s]
  input x
  parameter a ~ normal(0, sd = 2)
  parameter b ~ normal(0, sd = 2)
  observe y ~ normal(a*lag(measured(y), 1) + b*x, sd = 0.7)
}
data points { file "points.csv"; time t [s]; input x = x; measure y = y }
posterior = fit arx to points with map, seed = 1
)";
  CHECK(log_evidence(text, points.csv) == doctest::Approx(linear_evidence(points.y.tail(29), columns, 2, 0.7)).epsilon(1e-7));
}

TEST_CASE("coefficients beside a process count the same whether they are integrated out or sampled") {
  Points const points;
  Eigen::MatrixXd columns(30, 3), covariance(30, 30);
  columns << Eigen::VectorXd::Ones(30), points.x, points.x.cwiseAbs2();
  for (int i = 0; i < 30; ++i)
    for (int j = 0; j < 30; ++j)
      covariance(i, j) = 0.25 * std::exp(-0.5 * std::pow((points.x[i] - points.x[j]) / 0.8, 2)) + (i == j ? 0.49 : 0);
  double const exact = log_normal(points.y, covariance + 4 * columns * columns.transpose());
  // What is linear in all of its parameters is sampled; a switch far away leaves one that is not, and the other two are integrated
  // out.
  std::string const sampled = R"(
model grey {
  input x
  parameter a ~ normal(0, sd = 2)
  parameter b ~ normal(0, sd = 2)
  parameter c ~ normal(0, sd = 2)
  function f(u) ~ gp(squared_exponential(amplitude = 0.5, length = 0.8))
  observe y ~ normal(a + b*x + c*x^2 + f(x), sd = 0.7)
}
data points { file "points.csv"; input x = x; measure y = y }
posterior = fit grey to points with map, seed = 1
)";
  std::string const integrated = with(sampled, "c*x^2 +", "c*x^2 + (if c < -1e6 then 1 else 0) +");
  CHECK(CaseRun(integrated, {{"points.csv", points.csv}}).summary("posterior").at("settings").at("integrated_out") == "a, b");
  CHECK_FALSE(CaseRun(sampled, {{"points.csv", points.csv}}).summary("posterior").at("settings").contains("integrated_out"));
  CHECK(log_evidence(sampled, points.csv) == doctest::Approx(exact).epsilon(1e-6));
  CHECK(log_evidence(integrated, points.csv) == doctest::Approx(exact).epsilon(1e-6));
}

TEST_CASE("over hyper-parameters of a process the evidence agrees with quadrature") {
  Points const points;
  std::string const text = R"(
model smooth {
  input x
  parameter s     ~ log_uniform(0.05, 5)
  parameter l     ~ log_normal(median = 1, sd = 0.5)
  parameter sigma ~ log_uniform(0.1, 5)
  function f(u) ~ gp(squared_exponential(amplitude = s, length = l))
  observe y ~ normal(f(x), sd = sigma)
}
data points { file "points.csv"; input x = x; measure y = y }
posterior = fit smooth to points with map, seed = 1
)";
  // The midpoint rule over logarithms: of l five sds of its prior to either side.
  constexpr int steps = 40;
  double sum = 0;
  for (int i = 0; i < steps; ++i)
    for (int j = 0; j < steps; ++j)
      for (int k = 0; k < steps; ++k) {
        double const s = 0.05 * std::pow(100, (i + 0.5) / steps), z = -5 + 10 * (j + 0.5) / steps,
                     sigma = 0.1 * std::pow(50, (k + 0.5) / steps), l = std::exp(0.5 * z);
        Eigen::MatrixXd covariance(30, 30);
        for (int a = 0; a < 30; ++a)
          for (int b = 0; b <= a; ++b)
            covariance(a, b) = covariance(b, a) =
                s * s * std::exp(-0.5 * std::pow((points.x[a] - points.x[b]) / l, 2)) + (a == b ? sigma * sigma : 0);
        double const prior_l = std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi) * 10 / steps;
        sum += std::exp(log_normal(points.y, covariance)) * prior_l / (steps * steps);
      }
  double const exact = std::log(sum);
  // Laplace's own error with 30 points and three hyper-parameters is some tenths of a nat.
  CHECK(std::fabs(log_evidence(text, points.csv) - exact) < 0.3);
}

TEST_CASE("an optimum at a bound has an evidence all the same, and what has none says why") {
  Points const points;
  // The mean alone, pressed against its upper bound.
  std::string const bounded =
      with(with(line, "  parameter b [mm] ~ normal(0, sd = 2)\n", ""), "normal(a + b*x, sd = 0.7)", "normal(a, sd = 0.7)");
  double sum = 0;
  constexpr int steps = 20000;
  for (int i = 0; i < steps; ++i) {
    Eigen::ArrayXd const rest = (points.y.array() - (-1 + 1.5 * (i + 0.5) / steps)) / 0.7;
    sum += std::exp(-0.5 * rest.square().sum() - 30 * std::log(0.7 * std::sqrt(2 * std::numbers::pi))) / steps;
  }
  json const found = evidence(with(bounded, "normal(0, sd = 2)", "uniform(-1, 0.5)"), points.csv);
  double const off = std::log(sum) - found.at("laplace").get<double>(), along = found.at("along_axes").get<double>();
  CHECK(std::fabs(found.at("log_evidence").get<double>() - std::log(sum)) < 0.02);  // by weighted draws
  CHECK(std::fabs(off) < 0.15);
  CHECK(std::fabs(off) > 0.05);                          // the density is far from normal,
  CHECK(std::fabs(off - along) < 0.5 * std::fabs(off));  // which its axes tell

  json const likeliest = evidence(with(line, "map", "ml"), points.csv);
  CHECK(likeliest.at("log_evidence").is_null());
  CHECK(likeliest.at("reason").get<std::string>().find("only the likelihood") != std::string::npos);
  CaseRun const quiet(with(line, "map", "ml"), {{"points.csv", points.csv}});
  CHECK(quiet.result.out.find("log evidence") == std::string::npos);
  CaseRun const told(line, {{"points.csv", points.csv}});
  CHECK(told.result.out.find("\nlog evidence -") != std::string::npos);
}

TEST_CASE("a population whose density grows without bound as its spread vanishes has no evidence") {
  std::string const text = R"(
model groups {
  parameter mu ~ normal(0, sd = 5)
  parameter tau ~ half_normal(sd = 5)
  parameter k per experiment ~ normal(mu, sd = tau)
  observe y ~ normal(k, sd = 3)
}
data first  { file "points.csv"; measure y = t }
data second { file "points.csv"; measure y = x }
data third  { file "points.csv"; measure y = y }
posterior = fit groups to first, second, third with map, seed = 1
)";
  json const found = evidence(text, "t,x,y\n0.1,0.2,0.3\n0.2,0.1,0.2\n");
  CAPTURE(found.dump());
  CHECK(found.at("log_evidence").is_null());
  CHECK(found.at("reason").get<std::string>().find("tau") != std::string::npos);
}
