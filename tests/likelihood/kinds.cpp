// Models of every kind of dynamics against plain loops: rows without dynamics, discrete time under each rule of prediction, changes
// since the last row, counts; and the same bytes for any lanes and threads.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "experiment/experiments.hpp"
#include "likelihood/model_target.hpp"
#include "likelihood/output.hpp"
#include "load/load.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

double const missing = std::nan("");

Model kinds_model(std::string const& statements) {
  Source source("case.sysid", "model case {\n" + statements + "}\n");
  Diagnostics diagnostics;
  auto file = load(source, diagnostics);
  REQUIRE_MESSAGE(file, render(diagnostics, source));
  return file->models.front();
}

double normal(double x, double mean, double sd) {
  double const r = (x - mean) / sd;
  return -0.5 * std::log(2 * std::numbers::pi) - std::log(sd) - 0.5 * r * r;
}

/// A model on a record of columns, rows `step` apart.
struct KindsCase {
  Model model;
  Record record;

  KindsCase(std::string const& statements, double step, std::vector<std::vector<double>> const& inputs,
            std::vector<std::vector<double>> const& measured, PredictionRule rule = PredictionRule::as_written)
      : model(*with_prediction(kinds_model(statements), rule)) {
    std::size_t const rows = measured.front().size();
    for (std::size_t i = 0; i < rows; ++i) record.time.push_back(static_cast<double>(i) * step);
    for (auto const& input : inputs) record.inputs.emplace_back(InputRule::zero_order, record.time, input);
    record.measured = measured;
  }
  Experiment experiment() const { return cut(record, DataBlock{}, model, -1, {}); }
  ModelTarget target(ExecutionOptions execution = {}) const {
    TargetOptions options;
    options.execution = execution;
    return ModelTarget(compile(model, false, "rk4"), experiment(), options);
  }
  /// The log likelihood at declared values, one lane per vector.
  std::vector<double> all(std::vector<std::vector<double>> const& vectors, ExecutionOptions execution = {}) const {
    ModelTarget const on = target(execution);
    int const width = static_cast<int>(vectors.size());
    LaneArray declared(on.dimension(), width), theta(on.dimension(), width);
    for (int w = 0; w < width; ++w)
      for (int p = 0; p < on.dimension(); ++p) declared(p, w) = vectors[static_cast<std::size_t>(w)][static_cast<std::size_t>(p)];
    on.unconstrain(declared, theta);
    Ledger ledger;
    std::vector<double> out(vectors.size());
    on.log_likelihood(theta, out, ledger);
    return out;
  }
  double at(std::vector<double> const& values) const { return all({values}).front(); }
};

doctest::Approx about(double value) { return relative(value, 1e-12); }

std::vector<double> wave(int rows, double turns, double size = 1) {
  std::vector<double> samples;
  for (int i = 0; i < rows; ++i) samples.push_back(size * std::sin(turns * i + 0.3) + 0.1 * size * std::cos(2.7 * i));
  return samples;
}

std::string const filter = R"(
  time discrete 0.1 [s]
  input x
  state y
  initial y = 0.5
  parameter a ~ uniform(-1, 1)
  parameter b ~ normal(0, sd = 1)
  y = a*lag(y, 1) + b*lag(x, 2)
  observe output ~ normal(y, sd = 0.2)
)";
std::string const autoregressive = R"(
  time discrete
  parameter a ~ uniform(-1, 1)
  parameter b ~ normal(0, sd = 1)
  observe output ~ normal(a*lag(measured(output), 1) + b*lag(measured(output), 2), sd = 0.2)
)";

}  // namespace

TEST_CASE("rows without dynamics are scored one by one, in any order") {
  std::string const text = R"(
    input u, v
    parameter a ~ normal(0, sd = 1)
    parameter b ~ normal(0, sd = 1)
    observe output ~ normal(a + b*u*v, sd = 0.3)
  )";
  std::vector<double> const u = wave(9, 0.9), v = wave(9, 0.4), y = wave(9, 1.7);
  KindsCase const here(text, 1, {u, v}, {y});
  CHECK(here.model.dynamics == Dynamics::none);
  double sum = 0;
  for (std::size_t i = 0; i < 9; ++i) sum += normal(y[i], 0.4 - 0.7 * u[i] * v[i], 0.3);
  CHECK(here.at({0.4, -0.7}) == about(sum));
  auto const backwards = [](std::vector<double> samples) { return std::vector(samples.rbegin(), samples.rend()); };
  CHECK(KindsCase(text, 1, {backwards(u), backwards(v)}, {backwards(y)}).at({0.4, -0.7}) == about(sum));
}

TEST_CASE("a state in discrete time follows its map from the given past, and lagged inputs are those of the record") {
  int const rows = 30;
  std::vector<double> const x = wave(rows, 0.8), y = wave(rows, 0.3);
  KindsCase const here(filter, 0.1, {x}, {y});
  CHECK(here.model.dynamics == Dynamics::discrete);
  CHECK(data_lag(here.model) == 2);
  double sum = 0, state = 0.5;
  for (std::size_t i = 2; i < rows; ++i) {
    state = 0.6 * state - 0.4 * x[i - 2];
    sum += normal(y[i], state, 0.2);
  }
  CHECK(here.at({0.6, -0.4}) == about(sum));
  CHECK(here.experiment().first_row == 3);
}

TEST_CASE("a map is not run in substeps") {
  std::vector<double> const x = wave(10, 0.8);
  KindsCase const here(filter, 0.1, {x}, {x});
  auto const compiled = compile(here.model, false, "rk4");
  CHECK_NOTHROW(Schedule(*compiled->trajectory, here.experiment(), {.substeps = 1}));
  CHECK_THROWS_AS(Schedule(*compiled->trajectory, here.experiment(), {.substeps = 2}), InternalError);
}

TEST_CASE("what a model predicts is looked at where its likelihood is: not behind a gap that the density reads") {
  std::vector<double> y = wave(25, 0.7);
  y[11] = missing;
  KindsCase const here(autoregressive, 0.1, {}, {y});
  auto const compiled = compile(here.model, false, "rk4");
  auto const space = std::make_shared<ParameterSpace const>(here.model, std::vector<ExperimentMember>{{"case", {}}});
  Output const output(compiled, space, {here.experiment()}, {}, 0, {}, nullptr);
  CHECK(output.places().size() == 20);  // of 23 with two before them, neither the gap nor the two behind it
  LaneArray point(output.point_rows(), 1), centres(20, 1);
  for (int r = 0; r < point.rows(); ++r) point(r, 0) = 0.1;
  output.centres(point, centres);
  for (int r = 0; r < 20; ++r) CHECK(std::isfinite(centres(r, 0)));
}

TEST_CASE("measured samples enter by lag; rows without their past are not scored") {
  int const rows = 25;
  std::vector<double> y = wave(rows, 0.7);
  y[11] = missing;
  KindsCase const here(autoregressive, 0.1, {}, {y});
  double sum = 0;
  for (std::size_t i = 2; i < rows; ++i) {
    double const term = normal(y[i], 0.5 * y[i - 1] + 0.2 * y[i - 2], 0.2);
    if (!std::isnan(term)) sum += term;
  }
  CHECK(here.at({0.5, 0.2}) == about(sum));
  CHECK(here.target().residual_count() == rows - 2 - 3 + 1);  // the gap costs its own row and the two after it
}

TEST_CASE("one-step prediction puts measured samples in the place of lagged states that a channel observes") {
  int const rows = 20;
  std::vector<double> const x = wave(rows, 0.8), y = wave(rows, 0.3);
  KindsCase const here(filter, 0.1, {x}, {y}, PredictionRule::one_step);
  CHECK(here.model.states.empty());
  double sum = 0;
  for (std::size_t i = 2; i < rows; ++i) sum += normal(y[i], 0.6 * y[i - 1] - 0.4 * x[i - 2], 0.2);
  CHECK(here.at({0.6, -0.4}) == about(sum));
  CHECK_FALSE(with_prediction(kinds_model("time discrete\nstate y\ninitial y = 1\nparameter a ~ uniform(0, 1)\ny = a*lag(y, 1)\n"
                                          "observe twice ~ normal(2*y, sd = 1)\n"),
                              PredictionRule::one_step));
}

TEST_CASE("a free run goes on from its own predictions, beginning with what was measured") {
  int const rows = 20;
  std::vector<double> const y = wave(rows, 0.3);
  KindsCase const here(autoregressive, 0.1, {}, {y}, PredictionRule::free_run);
  double sum = 0, one = y[1], two = y[0];
  for (std::size_t i = 2; i < rows; ++i) {
    double const now = 0.5 * one + 0.2 * two;
    sum += normal(y[i], now, 0.2);
    two = one;
    one = now;
  }
  CHECK(here.at({0.5, 0.2}) == about(sum));
}

TEST_CASE("lagged residuals make a moving average, from a past without any") {
  std::string const text = R"(
    time discrete
    parameter c ~ uniform(-1, 1)
    observe output ~ normal(c*lag(residual(output), 1), sd = 0.2)
  )";
  int const rows = 20;
  std::vector<double> const y = wave(rows, 0.3);
  KindsCase const here(text, 0.1, {}, {y});
  // The prediction before the first row is what was measured there: no residual.
  double sum = 0, residual = 0;
  for (std::size_t i = 1; i < rows; ++i) {
    sum += normal(y[i], 0.7 * residual, 0.2);
    residual = y[i] - 0.7 * residual;
  }
  CHECK(here.at({0.7}) == about(sum));
}

TEST_CASE("a past that begins with the record's own samples, and lags of whole expressions") {
  std::string const text = R"(
    time discrete 0.1 [s]
    input x
    state y, z
    initial y = measured(output), z = 2
    parameter a ~ uniform(-1, 1)
    let drive = x*y
    y = a*lag(y, 2) + lag(drive, 1)
    z = 0.5*lag(z, 1) + y
    observe output ~ normal(y, sd = 0.2)
    observe other ~ normal(z + lag(z, 2), sd = 0.3)
  )";
  int const rows = 12;
  std::vector<double> const x = wave(rows, 0.8, 0.5), y = wave(rows, 0.3), other = wave(rows, 0.5);
  KindsCase const here(text, 0.1, {x}, {y, other});
  CHECK(data_lag(here.model) == 2);
  double sum = 0, one = y[1], two = y[0], z = 2, z1 = 2, z2 = 2;
  for (std::size_t i = 2; i < rows; ++i) {
    double const now = 0.4 * two + x[i - 1] * one;
    z = 0.5 * z1 + now;
    sum += normal(y[i], now, 0.2) + normal(other[i], z + z2, 0.3);
    two = one, one = now;
    z2 = z1, z1 = z;
  }
  CHECK(here.at({0.4}) == about(sum));
}

TEST_CASE("a gap that the state goes on from is refused, and left alone in a free run") {
  std::string const text = R"(
    time discrete
    state y
    initial y = 0
    parameter a ~ uniform(-1, 1)
    y = a*lag(measured(output), 1) + 0.1*lag(y, 1)
    observe output ~ normal(y, sd = 0.2)
  )";
  std::vector<double> y = wave(10, 0.3);
  y[5] = missing;
  CHECK_THROWS_AS(KindsCase(text, 0.1, {}, {y}).experiment(), UserError);
  CHECK_NOTHROW(KindsCase(text, 0.1, {}, {y}, PredictionRule::free_run).experiment());
}

TEST_CASE("counts of a change since the last row are Poisson with the mean of that interval") {
  std::string const text = R"(
    state n
    initial n = 1000
    parameter k [1/s] ~ log_uniform(0.01, 10)
    n' = -k*n
    observe gone ~ poisson(-since_last(n))
  )";
  std::vector<double> const counts = {missing, 95, 80, missing, 77, 60};
  KindsCase const here(text, 1, {}, {counts});
  double sum = 0;
  for (std::size_t i = 1; i < counts.size(); ++i) {
    double const t = static_cast<double>(i), mean = 1000 * (std::exp(-0.1 * (t - 1)) - std::exp(-0.1 * t));
    if (!std::isnan(counts[i])) sum += counts[i] * std::log(mean) - mean - std::lgamma(counts[i] + 1);
  }
  // One Runge-Kutta step of 1 s: (0.1)^5/120 of n.
  CHECK(here.at({0.1}) == doctest::Approx(sum).epsilon(1e-6));
}

TEST_CASE("nothing has changed at the first row: a count of 0 is certain there and any other impossible") {
  std::string const text = R"(
    state n
    initial n = 1
    parameter k [1/s] ~ log_uniform(0.01, 10)
    n' = k
    observe made ~ negative_binomial(since_last(n), shape = 3)
  )";
  std::vector<double> const possible = {0, 2}, impossible = {1, 2};
  double const lr = std::log(3.0) - std::log(5.0), ly = std::log(2.0) - std::log(5.0);  // mean 2, shape 3, count 2
  CHECK(KindsCase(text, 1, {}, {possible}).at({2}) == doctest::Approx(std::log(6.0) + 3 * lr + 2 * ly).epsilon(1e-12));
  CHECK(std::isinf(KindsCase(text, 1, {}, {impossible}).at({2})));
}

TEST_CASE("models of every kind give the same bytes for any lanes and threads") {
  std::vector<double> const x = wave(40, 0.8), y = wave(40, 0.3);
  std::vector<double> counts;
  for (int i = 0; i < 40; ++i) counts.push_back(i % 5);
  std::vector<KindsCase> const cases = {
      {filter, 0.1, {x}, {y}},
      {filter, 0.1, {x}, {y}, PredictionRule::one_step},
      {autoregressive, 0.1, {}, {y}, PredictionRule::free_run},
      {"input x\nparameter a ~ uniform(-1, 1)\nparameter b ~ normal(0, sd = 1)\nobserve o ~ normal(a + b*x, sd = 1)\n",
       1,
       {x},
       {y}},
      {"input x\nstate n\ninitial n = 5\nparameter a ~ uniform(-1, 1)\nparameter b ~ normal(0, sd = 1)\n"
       "n' = 1 + 0.5*a*sin(b*n)\nobserve o ~ negative_binomial(2 + abs(x*since_last(n)), shape = 2)\n",
       1,
       {x},
       {counts}},
  };
  std::vector<std::vector<double>> vectors;
  for (int w = 0; w < 37; ++w) vectors.push_back({0.9 * std::sin(w), std::cos(1.3 * w)});
  for (KindsCase const& each : cases) {
    std::vector<double> const reference = each.all(vectors, {.lanes = 1, .threads = 1});
    CHECK(each.all(vectors, {.lanes = 4, .threads = 1}) == reference);
    CHECK(each.all(vectors, {.lanes = 16, .threads = 2}) == reference);
    CHECK(each.all(vectors, {.lanes = 0, .threads = 4}) == reference);
  }
}
