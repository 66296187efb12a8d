// The Target of a model against arithmetic written out by hand: likelihood with its constants, units, channels, missing samples,
// priors.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "likelihood/model_target.hpp"
#include "load/load.hpp"

using namespace sysid;

namespace {

CheckedFile checked_file(std::string const& text) {
  Source source("case.sysid", text);
  Diagnostics diagnostics;
  auto file = load(source, diagnostics);
  REQUIRE_MESSAGE(file, render(diagnostics, source));
  return *file;
}

// A damped oscillator; position in mm with noise in mm, acceleration in m/s^2 with noise of precision beta.
std::string const text = R"(
model oscillator {
  input x [N]
  state y [mm]
  initial y = 2, y' = 0
  parameter m [kg] ~ log_uniform(0.5, 2)
  parameter k [N/mm] ~ log_normal(median = 0.1, sd = 0.5)
  parameter sigma [mm] ~ half_normal(sd = 0.5*width)
  constant width [cm] = 0.2
  constant c [N s/m] = 3
  m*y'' + c*y' + k*y = x
  observe position ~ normal(y, sd = sigma)
  observe acceleration [m/s^2] ~ normal(y'', precision = 4)
}
)";

struct TargetCase {
  std::shared_ptr<CompiledModel const> compiled = compile(checked_file(text).models.front(), false, "rk4");
  Experiment experiment;
  std::vector<double> force;

  TargetCase() {
    int const n = 40;
    for (int i = 0; i < n; ++i) {
      experiment.time.push_back(0.01 * i);
      force.push_back(std::sin(0.7 * i));
    }
    experiment.inputs.emplace_back(InputRule::linear, experiment.time, force);
    experiment.scored.assign(n, 1);
    for (int i = 0; i < 5; ++i) experiment.scored[static_cast<std::size_t>(i)] = 0;
    experiment.measured = {std::vector<double>(n), std::vector<double>(n)};
    for (int i = 0; i < n; ++i) {
      experiment.measured[0][static_cast<std::size_t>(i)] = 1e-3 * std::cos(0.1 * i);  // SI: metres
      experiment.measured[1][static_cast<std::size_t>(i)] = -0.2 * std::cos(0.1 * i);
    }
    experiment.measured[0][7] = std::nan("");
    experiment.measured[1][20] = std::nan("");
  }
};

// The same likelihood by a plain loop in metres and newtons; densities per mm and per m/s^2.
double by_hand(TargetCase const& c, double m, double k, double sigma_mm) {
  double const h = 0.01, sigma = 1e-3 * sigma_mm, k_si = 1e3 * k;
  double y = 2e-3, v = 0, sum = 0;
  auto const a = [&](double position, double speed, double x) { return (x - 3 * speed - k_si * position) / m; };
  for (std::size_t i = 0; i < c.force.size(); ++i) {
    if (c.experiment.scored[i] != 0) {
      double const r = (c.experiment.measured[0][i] - y) / sigma, s = c.experiment.measured[1][i] - a(y, v, c.force[i]);
      if (!std::isnan(r)) sum += -0.5 * std::log(2 * std::numbers::pi) - std::log(sigma_mm) - 0.5 * r * r;
      if (!std::isnan(s)) sum += 0.5 * std::log(4 / (2 * std::numbers::pi)) - 2 * s * s;
    }
    if (i + 1 == c.force.size()) break;
    double const x0 = c.force[i], x2 = c.force[i + 1], x1 = 0.5 * (x0 + x2);
    double const k1 = v, l1 = a(y, v, x0), k2 = v + h / 2 * l1, l2 = a(y + h / 2 * k1, v + h / 2 * l1, x1);
    double const k3 = v + h / 2 * l2, l3 = a(y + h / 2 * k2, v + h / 2 * l2, x1), k4 = v + h * l3,
                 l4 = a(y + h * k3, v + h * l3, x2);
    y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    v += h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
  }
  return sum;
}

double const values[][3] = {{1.2, 0.15, 0.4}, {0.6, 0.05, 1.5}, {1.9, 0.3, 0.1}};  // m [kg], k [N/mm], sigma [mm]

LaneArray theta_of(ModelTarget const& target) {
  LaneArray declared(3, 3), theta(3, 3);
  for (int w = 0; w < 3; ++w)
    for (int p = 0; p < 3; ++p) declared(p, w) = values[w][p];
  target.unconstrain(declared, theta);
  return theta;
}

}  // namespace

TEST_CASE("the log likelihood is the sum over scored samples that are there, per declared unit, with all constants") {
  TargetCase const c;
  ModelTarget const target(c.compiled, c.experiment, {});
  Ledger ledger;
  std::vector<double> out(3);
  target.log_likelihood(theta_of(target), out, ledger);
  for (std::size_t w = 0; w < 3; ++w)
    CHECK(out[w] == doctest::Approx(by_hand(c, values[w][0], values[w][1], values[w][2])).epsilon(1e-10));
  CHECK(ledger.solves() == 3);
  CHECK(ledger.failed() == 0);
}

TEST_CASE("half the sum of squared residuals is minus the log likelihood up to one constant for all parameters") {
  TargetCase const c;
  ModelTarget const target(c.compiled, c.experiment, {});
  CHECK(target.residual_count() == 34 + 34 + 2);  // 35 scored rows each, one missing in each channel, one scale row per channel
  LaneArray residuals(target.residual_count(), 3);
  Ledger ledger;
  std::vector<double> out(3), halves(3, 0.0);
  target.residuals(theta_of(target), residuals, ledger);
  target.log_likelihood(theta_of(target), out, ledger);
  for (int w = 0; w < 3; ++w)
    for (int r = 0; r < residuals.rows(); ++r) halves[static_cast<std::size_t>(w)] += 0.5 * residuals(r, w) * residuals(r, w);
  CHECK(halves[1] + out[1] == doctest::Approx(halves[0] + out[0]).epsilon(1e-11));
  CHECK(halves[2] + out[2] == doctest::Approx(halves[0] + out[0]).epsilon(1e-11));
}

TEST_CASE("the log prior is the declared density per declared unit, and the Jacobian makes it one over the coordinates") {
  TargetCase const c;
  ModelTarget const target(c.compiled, c.experiment, {});
  LaneArray const theta = theta_of(target);
  std::vector<double> declared(3), unconstrained(3);
  target.log_prior(theta, declared, false);
  target.log_prior(theta, unconstrained, true);
  for (std::size_t w = 0; w < 3; ++w) {
    double const m = values[w][0], k = values[w][1], s = values[w][2], z = std::log(k / 0.1) / 0.5;
    double const by_hand = -std::log(m * std::log(4.0)) - std::log(k * 0.5 * std::sqrt(2 * std::numbers::pi)) - 0.5 * z * z +
                           std::log(2 / std::sqrt(2 * std::numbers::pi)) - 0.5 * s * s;  // half the width is 1 mm
    CHECK(declared[w] == doctest::Approx(by_hand).epsilon(1e-11));
    // d(declared)/d(theta) by central differences.
    double jacobian = 0;
    for (int p = 0; p < 3; ++p) {
      LaneArray up(3, 1), down(3, 1), a(3, 1), b(3, 1);
      for (int q = 0; q < 3; ++q) up(q, 0) = down(q, 0) = theta(q, static_cast<int>(w));
      up(p, 0) += 1e-5;
      down(p, 0) -= 1e-5;
      target.constrain(up, a);
      target.constrain(down, b);
      jacobian += std::log((a(p, 0) - b(p, 0)) / 2e-5);
    }
    CHECK(unconstrained[w] - declared[w] == doctest::Approx(jacobian).epsilon(1e-8));
  }
}

TEST_CASE("prior draws follow the priors in declared units") {
  TargetCase const c;
  ModelTarget const target(c.compiled, c.experiment, {});
  int const n = 4000;
  LaneArray theta(3, n), declared(3, n);
  target.sample_prior({5, Purpose::prior, 0, 0}, theta);
  target.constrain(theta, declared);
  double square = 0, below = 0;
  for (int w = 0; w < n; ++w) {
    double const ratio = declared(2, w);  // |N(0, 1)|
    square += ratio * ratio / n;
    below += (declared(1, w) < 0.1) / static_cast<double>(n);
  }
  CHECK(std::abs(square - 1) < 4 * std::sqrt(2.0 / n));
  CHECK(std::abs(below - 0.5) < 4 * 0.5 / std::sqrt(n));
}

TEST_CASE("a diverging lane is minus infinity, is counted with its place, and leaves its neighbours alone") {
  std::string const unstable = R"(
model runaway {
  input x
  state y
  initial y = 1
  parameter a ~ uniform(-10, 1000)
  y' = a*y^3 + x
  observe level ~ normal(y, sd = 1)
}
)";
  Experiment experiment;
  for (int i = 0; i < 200; ++i) experiment.time.push_back(0.1 * i);
  experiment.inputs.emplace_back(InputRule::zero_order, experiment.time, std::vector<double>(200, 0.0));
  experiment.scored.assign(200, 1);
  experiment.measured = {std::vector<double>(200, 0.0)};
  TargetOptions options;
  options.describe = [](NodeId, Graph const&) { return std::string("the cube"); };
  ModelTarget const target(compile(checked_file(unstable).models.front(), false, "rk4"), experiment, options);
  LaneArray declared(1, 3), theta(1, 3);
  declared(0, 0) = -1;
  declared(0, 1) = 900;
  declared(0, 2) = -2;
  target.unconstrain(declared, theta);
  std::vector<double> out(3), alone(1);
  Ledger ledger;
  target.log_likelihood(theta, out, ledger);
  CHECK(std::isinf(out[1]));
  CHECK(out[1] < 0);
  REQUIRE(ledger.failures().size() == 1);
  CHECK(ledger.failures().front().where == "the cube");
  CHECK(ledger.failures().front().count == 1);
  CHECK(ledger.failures().front().example.front() == doctest::Approx(900));
  LaneArray one(1, 1);
  one(0, 0) = theta(0, 2);
  target.log_likelihood(one, alone, ledger);
  CHECK(alone[0] == out[2]);
}
