// Derivatives of a model's target, experiment by experiment, against those that every target has; and what they cost.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "core/numeric/not_finite.hpp"
#include "likelihood/model_target.hpp"
#include "load/load.hpp"
#include "relative.hpp"

using namespace sysid;

namespace derivative_tests {
namespace {

Model model_of(std::string const& text) {
  Source source("case.sysid", text);
  Diagnostics diagnostics;
  auto file = load(source, diagnostics);
  REQUIRE_MESSAGE(file, render(diagnostics, source));
  return file->models.front();
}

// Shared (c), of a population (k), of each experiment alone (bias), with a bound that is estimated (top); one that nothing reads.
std::string const text = R"(
model mount {
  input x
  state y
  initial y = y0, y' = 0
  parameter y0 per experiment ~ normal(0, sd = 0.02)
  parameter k_mean ~ normal(200, sd = 30)
  parameter k_spread ~ half_normal(20)
  parameter k per experiment ~ normal(k_mean, sd = k_spread, lower = 20)
  parameter c ~ log_uniform(0.5, 5)
  parameter top ~ log_uniform(1, 2)
  parameter bias per experiment ~ uniform(-1, top)
  parameter idle ~ normal(0, sd = 1)
  parameter sigma ~ log_uniform(0.01, 1)
  y'' + c*y' + k*y = x + bias
  observe position ~ normal(y, sd = sigma)
  observe speed ~ student_t(y', degrees_of_freedom = 5, scale = 3*sigma)
}
)";

constexpr int experiments = 3;

// Of different length; the second measures no speed.
Experiment experiment(int which) {
  Experiment made;
  int const n = 40 + 10 * which;
  made.name = "e" + std::to_string(which);
  std::vector<double> force, position, speed;
  for (int i = 0; i < n; ++i) {
    made.time.push_back(0.01 * i);
    force.push_back(std::sin(0.7 * i + which));
    position.push_back(0.02 * std::cos(0.1 * i + which));
    speed.push_back(0.1 * std::sin(0.2 * i));
  }
  made.inputs.emplace_back(InputRule::linear, made.time, force);
  made.scored.assign(static_cast<std::size_t>(n), 1);
  made.measured = {position, which == 1 ? std::vector<double>{} : speed};
  made.measured[0][5] = std::nan("");
  return made;
}

std::unique_ptr<ModelTarget> target_of(std::string const& source, bool free_start, std::string const& method,
                                       ExecutionOptions execution = {}, double relative = SolverSettings{}.relative) {
  Model const model = model_of(source);
  std::vector<ExperimentMember> members;
  std::vector<Experiment> records;
  for (int e = 0; e < experiments; ++e) {
    records.push_back(experiment(e));
    members.push_back({records.back().name, {}});
  }
  TargetOptions options;
  options.start_rows = free_start ? 8 : 0;
  options.solver.method = method;
  options.solver.relative = relative;
  options.execution = execution;
  return std::make_unique<ModelTarget>(compile(model, free_start, method), std::make_shared<ParameterSpace const>(model, members),
                                       records, options);
}

LaneArray draws(Target const& target, int count) {
  LaneArray theta(target.dimension(), count);
  target.sample_prior({5, Purpose::prior, 0, 0}, theta);
  return theta;
}

/// Everything that the derivatives of a target are.
struct Slopes {
  std::vector<double> value;
  LaneArray gradient, residuals, jacobian, step, curvature;
};

std::vector<double> steps_of(Target const& target) {
  return std::vector<double>(static_cast<std::size_t>(target.dimension()), 2e-5);
}

Slopes empty_slopes(Target const& target, int width) {
  int const n = target.dimension(), rows = target.residual_count();
  return {std::vector<double>(static_cast<std::size_t>(width)),
          LaneArray(n, width),
          LaneArray(rows, width),
          LaneArray(rows * n, width),
          LaneArray(n, width),
          LaneArray(n * n, width)};
}

Slopes by_experiments(ModelTarget const& target, LaneArray const& theta, Ledger& ledger) {
  Slopes found = empty_slopes(target, theta.width());
  target.log_likelihood_gradient(theta, found.value, found.gradient, ledger);
  target.residuals_with_jacobian(theta, found.residuals, found.jacobian, ledger);
  target.gauss_newton(theta, steps_of(target), found.step, found.curvature, ledger);
  return found;
}

/// As of any target: every coordinate moved in every experiment.
Slopes of_any_target(ModelTarget const& target, LaneArray const& theta, Ledger& ledger) {
  Slopes found = empty_slopes(target, theta.width());
  target.Target::log_likelihood_gradient(theta, found.value, found.gradient, ledger);
  target.Target::residuals_with_jacobian(theta, found.residuals, found.jacobian, ledger);
  target.Target::gauss_newton(theta, steps_of(target), found.step, found.curvature, ledger);
  return found;
}

bool same(LaneArray const& a, LaneArray const& b) {
  bool equal = true;
  for (int r = 0; r < a.rows(); ++r) equal = equal && std::ranges::equal(a.row(r), b.row(r));
  return equal;
}

double largest(LaneArray const& a) {
  double most = 0;
  for (int r = 0; r < a.rows(); ++r)
    for (double const v : a.row(r)) most = std::max(most, std::fabs(v));
  return most;
}

double furthest(LaneArray const& a, LaneArray const& b) {
  double most = 0;
  for (int r = 0; r < a.rows(); ++r)
    for (int w = 0; w < a.width(); ++w) most = std::max(most, std::fabs(a(r, w) - b(r, w)));
  return most;
}

void check_same(ModelTarget const& target, LaneArray const& theta) {
  Ledger ledger;
  Slopes const found = by_experiments(target, theta, ledger), expected = of_any_target(target, theta, ledger);
  CHECK(found.value == expected.value);
  CHECK(same(found.residuals, expected.residuals));
  CHECK(same(found.jacobian, expected.jacobian));
  // Sums in another order: rounding, which in the gradient a difference over 1e-5 of a width magnifies.
  CHECK(furthest(found.curvature, expected.curvature) <= 1e-12 * largest(expected.curvature));
  CHECK(furthest(found.step, expected.step) <= 1e-12 * largest(expected.step));
  double most = 0;
  for (double const v : expected.value)
    if (std::isfinite(v)) most = std::max(most, std::fabs(v));
  CHECK(furthest(found.gradient, expected.gradient) <= 1e-14 * most / 1e-7);
}

}  // namespace

TEST_CASE("differences experiment by experiment are those of any target") {
  for (bool const free_start : {false, true}) {
    CAPTURE(free_start);
    auto const target = target_of(text, free_start, free_start ? "rk4" : "dopri5");
    REQUIRE(target->dimension() == 15);
    CHECK(target->derivatives() == DerivativeSource::differences);
    check_same(*target, draws(*target, 4));
  }
}

TEST_CASE("exact derivatives are near differences, at 0 of every coordinate too") {
  std::string method = "rk4";
  SUBCASE("fixed steps") {}
  SUBCASE("exact steps") { method = "exponential"; }
  auto const target = target_of(text, false, method);
  CHECK(target->derivatives() == DerivativeSource::exact);
  LaneArray theta = draws(*target, 3);
  for (int p = 0; p < theta.rows(); ++p)
    if (target->parameters()[static_cast<std::size_t>(p)].name != "k_mean") theta(p, 2) = 0;
  for (int w = 0; w < 3; ++w) {
    CAPTURE(w);
    Ledger ledger;
    LaneArray one(theta.rows(), 1);
    for (int p = 0; p < theta.rows(); ++p) one(p, 0) = theta(p, w);
    Slopes const found = by_experiments(*target, one, ledger), expected = of_any_target(*target, one, ledger);
    REQUIRE(std::isfinite(found.value[0]));
    CHECK(found.value[0] == doctest::Approx(expected.value[0]).epsilon(1e-12));
    CHECK(same(found.residuals, expected.residuals));
    // Central differences over 1e-5 of widths: rounding leaves some 1e-10 of the residuals' size, curvature of the same order.
    CHECK(furthest(found.gradient, expected.gradient) <= 1e-6 * largest(expected.gradient));
    CHECK(furthest(found.step, expected.step) <= 1e-6 * largest(expected.step));
    CHECK(furthest(found.curvature, expected.curvature) <= 1e-6 * largest(expected.curvature));
    CHECK(furthest(found.gradient, found.step) <= 1e-11 * largest(found.step));
  }
}

TEST_CASE("exact steps give the likelihood that small steps tend to") {
  for (bool const free_start : {false, true}) {
    auto const exact = target_of(text, free_start, "exponential"), adaptive = target_of(text, free_start, "dopri5", {}, 1e-12);
    LaneArray const theta = draws(*exact, 20);
    std::vector<double> found(20), expected(20);
    Ledger ledger;
    exact->log_likelihood(theta, found, ledger);
    adaptive->log_likelihood(theta, expected, ledger);
    for (std::size_t w = 0; w < 20; ++w) {
      REQUIRE(std::isfinite(expected[w]));
      CHECK(found[w] == doctest::Approx(expected[w]).epsilon(1e-8));
    }
  }
}

TEST_CASE("the gradient of the prior is exact, through populations and bounds that are estimated") {
  auto const target = target_of(text, false, "rk4");
  LaneArray const theta = draws(*target, 4);
  LaneArray gradient(theta.rows(), 4), expected(theta.rows(), 4);
  std::vector<double> value(4), same_value(4), density(4);
  target->log_prior_gradient(theta, value, gradient);
  target->Target::log_prior_gradient(theta, same_value, expected);
  target->log_prior(theta, density);
  CHECK(value == density);
  CHECK(furthest(gradient, expected) <= 1e-7 * largest(expected));
  // Of what stands alone: a normal density.
  for (int p = 0; p < theta.rows(); ++p)
    if (target->parameters()[static_cast<std::size_t>(p)].name == "idle")
      for (int w = 0; w < 4; ++w) CHECK(gradient(p, w) == relative(-theta(p, w), 1e-14));
  LaneArray alone(theta.rows(), 1);
  target->log_prior_gradient(theta.view().columns(2, 1), {value.data(), 1}, alone);
  for (int p = 0; p < theta.rows(); ++p) CHECK(alone(p, 0) == gradient(p, 2));
  target->log_prior_gradient(theta, value, gradient, false);
  target->Target::log_prior_gradient(theta, value, expected, false);
  CHECK(same(gradient, expected));
}

TEST_CASE("of more parameters than pay, steps of least squares take differences, and the gradient is that of the adjoint") {
  constexpr int count = 9;  // first-order lags in a row
  std::string lags = "model lags {\n  input x\n";
  auto const numbered = [](std::string const& name, int i) { return name + std::to_string(i); };
  for (int i = 1; i <= count; ++i) {
    lags += "  state " + numbered("y", i) + "\n  initial " + numbered("y", i) + " = 0\n";
    lags += "  parameter " + numbered("rate", i) + " ~ log_uniform(5, 100)\n";
    lags += "  parameter " + numbered("gain", i) + " ~ normal(1, sd = 0.2)\n";
    lags += "  " + numbered("y", i) + "' = " + numbered("rate", i) + "*(" + numbered("gain", i) + "*" +
            (i == 1 ? "x" : numbered("y", i - 1)) + " - " + numbered("y", i) + ")\n";
  }
  lags += "  observe position ~ normal(y9, sd = 0.1)\n  observe speed ~ normal(y3, sd = 0.1)\n}\n";
  std::string method = "rk4";
  SUBCASE("fixed steps") {}
  SUBCASE("exact steps") { method = "exponential"; }
  auto const target = target_of(lags, false, method);
  CHECK(target->derivatives() == DerivativeSource::mixed);
  CHECK(target->compiled()->adjoint);
  LaneArray const theta = draws(*target, 2);
  Ledger ledger;
  Slopes const found = by_experiments(*target, theta, ledger), expected = of_any_target(*target, theta, ledger);
  CHECK(same(found.jacobian, expected.jacobian));
  CHECK(furthest(found.curvature, expected.curvature) <= 1e-12 * largest(expected.curvature));
  for (std::size_t w = 0; w < 2; ++w) CHECK(found.value[w] == doctest::Approx(expected.value[w]).epsilon(1e-12));
  CHECK(furthest(found.gradient, expected.gradient) <= 1e-6 * largest(expected.gradient));
}

TEST_CASE("equations that jump where states or parameters are have their derivatives by differences; those that bend have not") {
  auto const with = [](std::string const& rate, std::string const& centre) {
    return target_of("model switched {\n  input x\n  state y\n  initial y = 0\n  parameter limit ~ normal(2, sd = 0.5)\n  y' = " +
                         rate + "\n  observe level ~ normal(" + centre + ", sd = 0.1)\n  observe other ~ normal(y, sd = 0.2)\n}\n",
                     false, "rk4")
        ->derivatives();
  };
  CHECK(with("x - limit*y", "y") == DerivativeSource::exact);
  CHECK(with("x - limit*abs(y)*y + min(y, limit)", "y") == DerivativeSource::exact);
  CHECK(with("x*sign(x - 1) - limit*y", "y") == DerivativeSource::exact);
  CHECK(with("if x > 0.5 then x else -limit*y", "y") == DerivativeSource::exact);
  CHECK(with("x - limit*sign(y)", "y") == DerivativeSource::differences);
  CHECK(with("if abs(y) >= limit then 0 else x", "y") == DerivativeSource::differences);
  CHECK(with("if x > limit then x else -y", "y") == DerivativeSource::differences);
  CHECK(with("x - limit*y", "floor(y)") == DerivativeSource::differences);
}

TEST_CASE("a lane whose tangents are not finite has its derivatives by differences") {
  // atan2 has no derivative where both arguments are 0, as they are at the start.
  auto const target = target_of(R"(
model turn {
  input x
  state y
  initial y = 0
  parameter rate ~ normal(2, sd = 0.5)
  y' = rate*(1 + atan2(y, y^2)) + 0*x
  observe level ~ normal(y, sd = 0.1)
  observe other ~ normal(y, sd = 0.2)
}
)",
                                false, "rk4");
  CHECK(target->derivatives() == DerivativeSource::exact);
  LaneArray const theta = draws(*target, 3);
  check_same(*target, theta);
  Ledger ledger;
  Slopes const found = by_experiments(*target, theta, ledger);
  CHECK(ledger.failed() == 0);
  CHECK(largest(found.curvature) > 0.1);
}

TEST_CASE("derivatives are the same bytes for any threads, lanes and neighbours") {
  bool free_start = false;  // exact derivatives; differences
  std::string method = "rk4";
  SUBCASE("exact") {}
  SUBCASE("exact steps") { method = "exponential"; }
  SUBCASE("differences") { free_start = true; }
  auto const one = target_of(text, free_start, method), two = target_of(text, free_start, method, {.lanes = 4, .threads = 2});
  LaneArray const theta = draws(*one, 5);
  Ledger ledger;
  Slopes const first = by_experiments(*one, theta, ledger), second = by_experiments(*two, theta, ledger);
  CHECK(first.value == second.value);
  CHECK(same(first.gradient, second.gradient));
  CHECK(same(first.jacobian, second.jacobian));
  CHECK(same(first.step, second.step));
  CHECK(same(first.curvature, second.curvature));
  LaneArray last(theta.rows(), 1);
  for (int p = 0; p < theta.rows(); ++p) last(p, 0) = theta(p, 4);
  Slopes const alone = by_experiments(*one, last, ledger);
  CHECK(alone.value[0] == first.value[4]);
  bool equal = true;
  for (int r = 0; r < alone.jacobian.rows(); ++r) equal = equal && alone.jacobian(r, 0) == first.jacobian(r, 4);
  for (int r = 0; r < alone.curvature.rows(); ++r) equal = equal && alone.curvature(r, 0) == first.curvature(r, 4);
  CHECK(equal);
}

TEST_CASE("an experiment is simulated for the coordinates that it reads, and once for lanes that are the same to it") {
  auto const target = target_of(text, false, "dopri5"), exact = target_of(text, false, "rk4");
  LaneArray const theta = draws(*target, 2);
  // Its own y0, k and bias, the bound of bias, c and sigma: not the population's mean and spread, and nothing of the others.
  constexpr int read = 6, lanes = 2;
  Ledger ledger;
  LaneArray residuals(target->residual_count(), lanes), jacobian(target->residual_count() * target->dimension(), lanes);
  target->residuals_with_jacobian(theta, residuals, jacobian, ledger);
  CHECK(ledger.solves() == experiments * lanes * (2 * read + 1));
  CHECK(target->derivative_cost() == 2 * read + 1);
  Ledger any;
  target->Target::residuals_with_jacobian(theta, residuals, jacobian, any);
  CHECK(any.solves() == ledger.solves());
  // All parameters at once: a value with its derivatives by five, by the bound of bias through the chain rule.
  Ledger exactly;
  Slopes squares = empty_slopes(*exact, lanes);
  exact->gauss_newton(theta, steps_of(*exact), squares.step, squares.curvature, exactly);
  CHECK(exactly.solves() == experiments * lanes * read);
  CHECK(exact->derivative_cost() == read + 1);
  // A hyper-parameter has no slope.
  for (int p = 0; p < target->dimension(); ++p) {
    if (!target->parameters()[static_cast<std::size_t>(p)].name.starts_with("k_")) continue;
    for (int r = 0; r < residuals.rows(); ++r) CHECK(jacobian(r * target->dimension() + p, 0) == 0);
  }
  // Lanes that differ in nothing, and in what no experiment reads.
  LaneArray repeated(theta.rows(), 3);
  for (int p = 0; p < theta.rows(); ++p) {
    bool const idle = target->parameters()[static_cast<std::size_t>(p)].name == "idle";
    for (int w = 0; w < 3; ++w) repeated(p, w) = theta(p, 0) + (idle ? w / 2 : 0);
  }
  Ledger few;
  std::vector<double> value(3), alone(1);
  target->log_likelihood(repeated, value, few);
  CHECK(few.solves() == experiments);
  target->log_likelihood(theta.view().columns(0, 1), alone, few);
  CHECK(value == std::vector<double>(3, alone[0]));
}

TEST_CASE("where a neighbour fails in one experiment, all take the other side; where a place fails there is no slope") {
  std::string const runaway = R"(
model runaway {
  input x
  state y
  initial y = start + shift
  parameter start ~ normal(0.5, sd = 0.5)
  parameter shift per experiment ~ normal(0, sd = 0.2)
  parameter idle ~ normal(0, sd = 1)
  y' = 40*y^3 + x
  observe level ~ normal(y, sd = 1)
  observe rate ~ normal(y', sd = 100)
}
)";
  std::string method = "dopri5";
  SUBCASE("differences") {}
  SUBCASE("exact") { method = "rk4"; }
  auto const target = target_of(runaway, false, method);
  REQUIRE(target->dimension() == 5);
  Ledger ledger;
  // The largest starts whose likelihood, and whose residuals, are finite, to within a part of a difference.
  auto const largest_start = [&](bool of_residuals) {
    double good = 0.05, bad = 1e3;
    while (bad - good > 1e-9) {
      LaneArray theta(5, 1), residuals(target->residual_count(), 1);
      theta(0, 0) = (good + bad) / 2;
      double value = 0;
      target->log_likelihood(theta, {&value, 1}, ledger);
      target->residuals(theta, residuals, ledger);
      (std::isfinite(of_residuals ? residuals(0, 0) : value) ? good : bad) = theta(0, 0);
    }
    return good;
  };
  LaneArray theta(5, 4);
  theta(0, 0) = largest_start(false);
  theta(0, 1) = 10;
  theta(0, 2) = 0.05;
  theta(0, 3) = largest_start(true);
  if (method == "dopri5") check_same(*target, theta);
  Slopes const found = by_experiments(*target, theta, ledger);
  CHECK(std::isfinite(found.value[0]));
  CHECK(found.value[1] == -infinity);
  CHECK(found.residuals(0, 1) == infinity);
  for (int r = 0; r < found.jacobian.rows(); ++r) CHECK(found.jacobian(r, 1) == 0);
  for (int p = 0; p < 5; ++p) {
    CHECK(found.gradient(p, 1) == 0);
    CHECK(found.step(p, 1) == 0);
  }
  CHECK(found.jacobian(0, 2) != 0);
}

}  // namespace derivative_tests
