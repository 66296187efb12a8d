// A target over several experiments: the sum of targets over each, the same bytes for any threads and lanes.
#include <doctest/doctest.h>

#include <cmath>

#include "likelihood/model_target.hpp"
#include "load/load.hpp"

using namespace sysid;

namespace {

Model oscillator() {
  Source source("case.sysid", R"(
model oscillator {
  input x
  state y
  initial y = y0, y' = 0
  parameter y0 per experiment ~ normal(0, sd = 1)
  parameter m ~ log_uniform(0.5, 2)
  parameter added per experiment = 0
  parameter k ~ log_uniform(50, 500)
  parameter bias per experiment ~ normal(0, sd = 1)
  parameter sigma per experiment ~ log_uniform(0.01, 1)
  (m + added)*y'' + 2*y' + k*y = x + bias
  observe position ~ normal(y, sd = sigma)
  observe acceleration ~ normal(y'', sd = 10*sigma)
}
)");
  Diagnostics diagnostics;
  auto file = load(source, diagnostics);
  REQUIRE_MESSAGE(file, render(diagnostics, source));
  return file->models.front();
}

constexpr int parameters = 6;

// Experiments of different length and step; the second measures no acceleration.
Experiment experiment(int which) {
  Experiment made;
  int const n = which == 0 ? 60 : 35;
  made.name = which == 0 ? "first" : "second";
  std::vector<double> force;
  for (int i = 0; i < n; ++i) {
    made.time.push_back((which == 0 ? 0.01 : 0.025) * i);
    force.push_back(std::sin(0.7 * i + which));
  }
  made.inputs.emplace_back(InputRule::linear, made.time, force);
  made.scored.assign(static_cast<std::size_t>(n), 1);
  std::vector<double> position, acceleration;
  for (int i = 0; i < n; ++i) {
    position.push_back(0.02 * std::cos(0.1 * i));
    acceleration.push_back(0.5 * std::sin(0.2 * i));
  }
  made.measured = {position, which == 0 ? acceleration : std::vector<double>{}};
  return made;
}

std::vector<std::optional<double>> added(double mass) {
  std::vector<std::optional<double>> values(parameters);
  values[2] = mass;
  return values;
}

std::shared_ptr<ParameterSpace const> space(std::vector<ExperimentMember> members) {
  return std::make_shared<ParameterSpace const>(oscillator(), std::move(members));
}

struct ExperimentsCase {
  bool free_start;
  std::shared_ptr<CompiledModel const> compiled = compile(oscillator(), free_start, "rk4");
  std::shared_ptr<ParameterSpace const> both = space({{"first", {}}, {"second", added(0.3)}});

  ModelTarget target(ExecutionOptions execution = {}) const {
    return ModelTarget(compiled, both, {experiment(0), experiment(1)}, options(execution));
  }
  TargetOptions options(ExecutionOptions execution = {}) const {
    TargetOptions options;
    options.start_rows = free_start ? 8 : 0;
    options.execution = execution;
    return options;
  }
};

LaneArray draws(Target const& target, int count) {
  LaneArray theta(target.dimension(), count);
  target.sample_prior({5, Purpose::prior, 0, 0}, theta);
  return theta;
}

// Coordinates of one experiment's own target out of those of both; rows of y0, m, k, bias, sigma.
LaneArray part_of(LaneArray const& theta, int which) {
  int const rows[2][5] = {{0, 2, 3, 4, 6}, {1, 2, 3, 5, 7}};
  LaneArray part(5, theta.width());
  for (int p = 0; p < 5; ++p)
    for (int w = 0; w < theta.width(); ++w) part(p, w) = theta(rows[which][p], w);
  return part;
}

}  // namespace

TEST_CASE("the log likelihood is the sum over the experiments, each with its own parameters, constants and channels") {
  for (bool const free_start : {false, true}) {
    ExperimentsCase const c{free_start};
    ModelTarget const both = c.target();
    REQUIRE(both.dimension() == 8);
    LaneArray const theta = draws(both, 9);
    std::vector<double> sum(9), one(9), two(9);
    Ledger ledger;
    both.log_likelihood(theta, sum, ledger);
    CHECK(ledger.solves() == 18);
    ModelTarget const first(c.compiled, space({{"first", {}}}), {experiment(0)}, c.options());
    ModelTarget const second(c.compiled, space({{"second", added(0.3)}}), {experiment(1)}, c.options());
    first.log_likelihood(part_of(theta, 0), one, ledger);
    second.log_likelihood(part_of(theta, 1), two, ledger);
    for (std::size_t w = 0; w < 9; ++w) {
      REQUIRE(std::isfinite(sum[w]));
      CHECK(sum[w] == doctest::Approx(one[w] + two[w]).epsilon(1e-13));
    }
    // A channel that is not measured has no rows but its scale, which is constant.
    CHECK(both.residual_count() == first.residual_count() + second.residual_count());
    int const scored = free_start ? 60 + 60 + 35 : 60 + 60 + 35;
    CHECK(both.residual_count() == scored + 4);
    LaneArray all(both.residual_count(), 9), residuals(first.residual_count(), 9), more(second.residual_count(), 9);
    both.residuals(theta, all, ledger);
    first.residuals(part_of(theta, 0), residuals, ledger);
    second.residuals(part_of(theta, 1), more, ledger);
    for (int w = 0; w < 9; ++w) {
      for (int r = 0; r < residuals.rows(); ++r) CHECK(all(r, w) == residuals(r, w));
      for (int r = 0; r < more.rows(); ++r) CHECK(all(residuals.rows() + r, w) == more(r, w));
    }
    CHECK(both.residual_places().back().experiment == 1);
    CHECK(ledger.failed() == 0);
  }
}

TEST_CASE("threads and lanes change no byte of a target over several experiments") {
  ExperimentsCase const c{true};
  ModelTarget const reference = c.target();
  LaneArray const theta = draws(reference, 70);
  std::vector<double> expected(70), found(70);
  LaneArray residuals(reference.residual_count(), 70), others(reference.residual_count(), 70);
  Ledger ledger;
  reference.log_likelihood(theta, expected, ledger);
  reference.residuals(theta, residuals, ledger);
  for (ExecutionOptions const& execution : {ExecutionOptions{0, 2}, {1, 1}, {4, 8}, {64, 3}}) {
    ModelTarget const other = c.target(execution);
    other.log_likelihood(theta, found, ledger);
    CHECK(found == expected);
    other.residuals(theta, others, ledger);
    bool same = true;
    for (int r = 0; r < residuals.rows(); ++r)
      for (int w = 0; w < 70; ++w) same = same && residuals(r, w) == others(r, w);
    CHECK(same);
  }
}

TEST_CASE("a failure names the experiment, and is the whole vector's") {
  Source source("case.sysid", R"(
model runaway {
  input x
  state y
  initial y = start
  parameter start per experiment ~ uniform(-1, 1000)
  y' = y^3 + x
  observe level ~ normal(y, sd = 1)
}
)");
  Diagnostics diagnostics;
  auto const file = load(source, diagnostics);
  REQUIRE_MESSAGE(file, render(diagnostics, source));
  Experiment quiet;
  for (int i = 0; i < 50; ++i) quiet.time.push_back(0.01 * i);
  quiet.inputs.emplace_back(InputRule::zero_order, quiet.time, std::vector<double>(50, 0.0));
  quiet.scored.assign(50, 1);
  quiet.measured = {std::vector<double>(50, 0.0)};
  Experiment other = quiet;
  quiet.name = "quiet";
  other.name = "loud";
  TargetOptions options;
  options.describe = [](NodeId, Graph const&) { return std::string("the cube"); };
  ModelTarget const target(
      compile(file->models.front(), false, "rk4"),
      std::make_shared<ParameterSpace const>(file->models.front(), std::vector<ExperimentMember>{{"quiet", {}}, {"loud", {}}}),
      {quiet, other}, options);
  LaneArray declared(2, 2), theta(2, 2);
  declared(0, 0) = declared(0, 1) = declared(1, 0) = 0.1;
  declared(1, 1) = 900;
  target.unconstrain(declared, theta);
  std::vector<double> out(2);
  Ledger ledger;
  target.log_likelihood(theta, out, ledger);
  CHECK(std::isfinite(out[0]));
  CHECK(out[1] == -std::numeric_limits<double>::infinity());
  REQUIRE(ledger.failures().size() == 1);
  CHECK(ledger.failures().front().where == "the cube on `loud`");
  CHECK(ledger.solves() == 3);  // both lanes are one to the quiet experiment
  LaneArray residuals(target.residual_count(), 2);
  target.residuals(theta, residuals, ledger);
  CHECK(std::isinf(residuals(0, 1)));
  CHECK(std::isfinite(residuals(0, 0)));
}
