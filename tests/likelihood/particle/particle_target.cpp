// What a target of particles promises beside its mean: the same bytes for any lanes and threads, numbers that can be kept and
// moved, failures that are counted, what channels read of a disturbance, what a model remembers.
#include <Eigen/Core>

#include <numbers>

#include "core/numeric/statistics.hpp"
#include "likelihood/particle/cases.hpp"
#include "linear_algebra/decompositions.hpp"
#include "relative.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

/// A pendulum with a kink, blown at.
Model blown_pendulum() {
  Model model = parsed_model(R"(
model pendulum {
  input w
  state y
  initial y = 0.2, y' = 0
  parameter k ~ log_uniform(1, 100)
  parameter q ~ log_uniform(0.01, 10)
  parameter s0 ~ log_uniform(0.01, 10)
  parameter sigma ~ log_uniform(0.01, 1)
  y'' + 0.3*y' + k*sin(y) + 0.4*sign(y') = w
  observe position ~ normal(y, sd = sigma)
}
)");
  disturb(model, "q");
  random_start(model, 1, "s0");
  return model;
}

Experiment blown_record(int samples, double first) {
  Experiment made;
  made.name = first > 0 ? "bench" : "site";
  made.measured.emplace_back();
  Stream noise(StreamKey{.seed = 5, .index = first > 0 ? 1U : 2U});
  for (int i = 0; i < samples; ++i) {
    made.time.push_back(0.05 * i);
    made.measured[0].push_back(first * std::cos(0.2 * i) + 0.05 * noise.normal());
  }
  made.measured[0][3] = std::nan("");
  made.scored.assign(made.time.size(), 1);
  return made;
}

std::vector<double> const pendulum_values = {16, 1.2, 0.4, 0.1};

std::vector<double> estimates(ParticleTarget const& target, ConstLanes theta, StreamKey key) {
  std::vector<double> out(static_cast<std::size_t>(theta.width()));
  Ledger ledger;
  target.estimate(theta, key, out, ledger);
  return out;
}

std::vector<double> values_of(ParticleTarget const& target, ConstLanes theta) {
  std::vector<double> out(static_cast<std::size_t>(theta.width()));
  Ledger ledger;
  target.log_likelihood(theta, out, ledger);
  CHECK(ledger.failed() == 0);
  return out;
}

double sd_of_differences(std::vector<double> const& a, std::vector<double> const& b) {
  std::vector<double> difference;
  for (std::size_t i = 0; i < a.size(); ++i) difference.push_back(a[i] - b[i]);
  return std::sqrt(sample_variance(difference));
}

}  // namespace

TEST_CASE("particles: the same bytes for any lanes, threads and executor, and in any batch") {
  Model const model = blown_pendulum();
  std::vector<Experiment> const experiments = {blown_record(30, 0.2), blown_record(20, -0.1)};
  auto const target = particle_target(model, experiments, 100);
  LaneArray theta = lanes_of(*target, pendulum_values, 3);
  for (int w = 0; w < 3; ++w) theta(0, w) += 0.05 * w;
  std::vector<double> const expected = values_of(*target, theta);
  CHECK(expected[0] != expected[1]);
  CHECK(std::isfinite(expected[0]));
  for (ExecutionOptions const& how :
       {ExecutionOptions{.lanes = 4, .threads = 2}, ExecutionOptions{.lanes = 8},
        ExecutionOptions{.executor = ExecutorKind::scalar}, ExecutionOptions{.threads = 3, .executor = ExecutorKind::native}}) {
    auto const other = particle_target(model, experiments, 100, {}, how);
    CHECK(values_of(*other, theta) == expected);
    CHECK(values_of(*other, theta.view().columns(1, 1)) == std::vector<double>{expected[1]});
  }
  SUBCASE("with an adaptive solver in lanes") {
    SolverSettings solver;
    solver.method = "dopri5";
    auto const one = particle_target(model, experiments, 40, solver, {.lanes = 4});
    auto const other = particle_target(model, experiments, 40, solver, {.lanes = 8, .threads = 2});
    CHECK(values_of(*one, theta) == values_of(*other, theta));
  }
}

TEST_CASE("particles: numbers that are kept give the estimate that fresh ones give, and fresh ones in their place another") {
  Model const model = blown_pendulum();
  auto const target = particle_target(model, {blown_record(30, 0.2)}, 96);
  int const lanes = 200;
  LaneArray const theta = lanes_of(*target, pendulum_values, lanes);
  StreamKey const key{.seed = 21, .index = 40, .step = 7};
  std::vector<double> const fresh = estimates(*target, theta, key);
  std::vector<ParticleAuxiliary> kept;
  for (int w = 0; w < lanes; ++w) kept.push_back(target->draw_auxiliary(key.with_index(key.index + static_cast<std::uint64_t>(w))));
  std::vector<double> stored(fresh.size());
  Ledger ledger;
  target->estimate(theta, kept, stored, ledger);
  CHECK(stored == fresh);
  CHECK(ledger.solves() == static_cast<std::uint64_t>(lanes));
  for (int w = 0; w < lanes; ++w)
    target->move_auxiliary(kept[static_cast<std::size_t>(w)], 0, {.seed = 22, .index = static_cast<std::uint64_t>(w)});
  target->estimate(theta, kept, stored, ledger);
  CHECK(sd_of_differences(stored, fresh) == doctest::Approx(std::sqrt(2 * sample_variance(fresh))).epsilon(0.3));
}

TEST_CASE("particles: of one state, estimates whose numbers or parameters move a little move little") {
  Model model = parsed_model(R"(
model leak {
  input w
  state y
  initial y = 1
  parameter k ~ log_uniform(0.1, 10)
  parameter q ~ log_uniform(0.01, 10)
  y' = -k*y*abs(y) + w
  observe level ~ normal(y, sd = 0.2)
}
)");
  disturb(model, "q");
  auto const target = particle_target(model, {blown_record(60, 0.5)}, 256);
  int const lanes = 200;
  LaneArray const theta = lanes_of(*target, {0.8, 0.9}, lanes);
  StreamKey const key{.seed = 23};
  std::vector<double> const fresh = estimates(*target, theta, key);
  double const sd = std::sqrt(sample_variance(fresh));  // independent ones would differ by sqrt(2) of it
  SUBCASE("by an autoregressive step") {
    std::vector<ParticleAuxiliary> kept;
    for (int w = 0; w < lanes; ++w) {
      kept.push_back(target->draw_auxiliary(key.with_index(static_cast<std::uint64_t>(w))));
      target->move_auxiliary(kept.back(), 0.999, {.seed = 22, .index = static_cast<std::uint64_t>(w)});
    }
    std::vector<double> moved(fresh.size());
    Ledger ledger;
    target->estimate(theta, kept, moved, ledger);
    MESSAGE("sd " << sd << ", of the differences " << sd_of_differences(moved, fresh));
    CHECK(sd_of_differences(moved, fresh) < 0.5 * sd);
    CHECK(std::sqrt(sample_variance(moved)) == doctest::Approx(sd).epsilon(0.3));
  }
  SUBCASE("by the parameters") {
    LaneArray moved = theta;
    for (int w = 0; w < lanes; ++w) moved(0, w) += 1e-3;
    std::vector<double> const values = estimates(*target, moved, key);
    MESSAGE("sd " << sd << ", of the differences " << sd_of_differences(values, fresh));
    CHECK(sd_of_differences(values, fresh) < 0.3 * sd);
  }
}

TEST_CASE("particles: the numbers of the likelihood are the same, kept or drawn again") {
  Model const model = blown_pendulum();
  std::vector<Experiment> const experiments = {blown_record(15, 0.2), blown_record(10, -0.1)};
  std::vector<ExperimentMember> const members = {{"bench", {}}, {"site", {}}};
  ParticleOptions frugal;
  frugal.particles = 64;
  frugal.stored_bytes = 0;
  ParticleTarget const target(particle_model(model, "rk4"), std::make_shared<ParameterSpace const>(model, members), experiments, {},
                              frugal);
  LaneArray const theta = lanes_of(target, pendulum_values, 2);
  CHECK(values_of(target, theta) == values_of(*particle_target(model, experiments, 64), theta));
}

TEST_CASE("particles: a parameter vector can have numbers of its own, the same wherever it is asked for") {
  Model const model = blown_pendulum();
  std::vector<Experiment> const experiments = {blown_record(15, 0.2), blown_record(10, -0.1)};
  auto const fixed = particle_target(model, experiments, 64);
  auto const target = fixed->with_numbers(ParticleNumbers::of_parameters);
  int const lanes = 400;
  LaneArray theta = lanes_of(*target, pendulum_values, lanes);
  for (int w = 0; w < lanes; ++w) theta(1, w) += 1e-12 * w;
  std::vector<double> const values = values_of(*target, theta);
  CHECK(values_of(*target, theta.view().columns(7, 3)) == std::vector<double>{values[7], values[8], values[9]});
  // As different as independent estimates, and as far from one another along the lanes as anywhere.
  double const independent = std::sqrt(sample_variance(estimates(*fixed, theta, {.seed = 51})));
  CHECK(std::sqrt(sample_variance(values)) == doctest::Approx(independent).epsilon(0.2));
  std::vector<double> const earlier(values.begin(), values.end() - 1), later(values.begin() + 1, values.end());
  CHECK(sd_of_differences(earlier, later) == doctest::Approx(std::sqrt(2) * independent).epsilon(0.2));
}

TEST_CASE("particles: where none is left the likelihood is zero, and the failure is counted at its place") {
  Model model = parsed_model(R"(
model growth {
  input w
  state y
  initial y = 1
  parameter k ~ log_uniform(0.1, 1000)
  parameter q ~ log_uniform(0.01, 10)
  y' = k*y^3 + w
  observe size ~ normal(y, sd = 1)
}
)");
  disturb(model, "q");
  std::vector<Experiment> experiments(2);
  for (Experiment& each : experiments) {
    each.time = {0, 0.1, 0.2, 0.3};
    each.measured = {{1, 1, 1, 1}};
    each.scored = {1, 1, 1, 1};
  }
  experiments[0].name = "calm", experiments[1].name = "wild";
  experiments[0].time = {0, 1e-6, 2e-6, 3e-6};
  auto const target = particle_target(model, experiments, 32);
  LaneArray theta = lanes_of(*target, {500, 0.1}, 2);
  theta(0, 1) = lanes_of(*target, {0.2, 0.1}, 1)(0, 0);
  std::vector<double> out(2);
  Ledger ledger;
  target->log_likelihood(theta, out, ledger);
  CHECK(out[0] == -std::numeric_limits<double>::infinity());
  CHECK(std::isfinite(out[1]));
  CHECK(ledger.solves() == 4);
  REQUIRE(ledger.failed() == 1);
  Failure const& failure = ledger.failures().front();
  CHECK(failure.kind == FailureClass::non_finite);
  CHECK(failure.where == "the densities of all particles on `wild`");
  CHECK(failure.time == relative(0.2, 1e-12));
  CHECK(failure.example[0] == doctest::Approx(500));
}

TEST_CASE("particles: an error that is held from sample to sample is the same in a channel and in the states") {
  Model model = parsed_model(R"(
model filter {
  input e
  state x
  initial x = 0
  parameter s ~ log_uniform(0.01, 10)
  x' = -2*x + 3 + e
  observe input_seen ~ normal(3 + e, sd = 0.5)
  observe output ~ normal(x, sd = 0.2)
}
)");
  disturb(model, "s", true);
  Experiment experiment;
  experiment.name = "record";
  double const gone = std::nan(""), s = 0.6, h = 0.2;
  experiment.measured = {{3.1, 2.5, gone, 3.9, 3.0, 2.6}, {0.1, 0.5, 0.9, 1.1, 1.4, 1.3}};
  for (int i = 0; i < 6; ++i) experiment.time.push_back(h * i);
  experiment.scored.assign(6, 1);
  // x = shares of the errors, and what 3 gives.
  double const keep = std::exp(-2 * h);
  Eigen::MatrixXd sees = Eigen::MatrixXd::Zero(11, 6);
  Eigen::VectorXd y(11), mean(11), variance(11);
  int row = 0;
  for (int i = 0; i < 6; ++i) {
    if (i == 2) continue;
    sees(row, i) = 1, y[row] = experiment.measured[0][static_cast<std::size_t>(i)], mean[row] = 3, variance[row++] = 0.25;
  }
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < i; ++j) sees(row, j) = std::pow(keep, i - 1 - j) * (1 - keep) / 2;
    y[row] = experiment.measured[1][static_cast<std::size_t>(i)], mean[row] = 1.5 * (1 - std::pow(keep, i)), variance[row++] = 0.04;
  }
  Eigen::MatrixXd covariance = s * s * sees * sees.transpose();
  covariance += variance.asDiagonal();
  Eigen::VectorXd const r = y - mean;
  double const exact =
      -0.5 * (11 * std::log(2 * std::numbers::pi) + log_absolute_determinant(covariance) + r.dot(inverse(covariance) * r));
  SolverSettings solver;
  solver.substeps = 4;
  Bias const found = bias(*particle_target(model, {experiment}, 64, solver), {s}, exact, 4000, 31);
  MESSAGE("z " << found.z << ", sd of an estimate " << found.relative_sd << " of the likelihood");
  CHECK(std::fabs(found.z) < 3);
}

TEST_CASE("particles: means of disturbances over a sampling interval do not depend on the steps of the solver") {
  Model model = parsed_model(R"(
model filter {
  input w, e
  state x
  initial x = 0
  parameter s ~ log_uniform(0.01, 10)
  parameter q ~ log_uniform(0.01, 10)
  x' = -2*x + w + e
  observe output ~ normal(x, sd = 0.2)
}
)");
  disturb(model, "s", true);
  disturb(model, "q");
  Experiment experiment;
  experiment.name = "record";
  double const gone = std::nan(""), h = 0.2;
  experiment.measured = {{0.1, gone, gone, gone}};
  for (int i = 0; i < 4; ++i) experiment.time.push_back(h * i);
  experiment.scored.assign(4, 1);
  auto const made = particle_model(model, "rk4");
  REQUIRE(made->noises.size() == 2);
  for (int const substeps : {1, 8}) {
    CAPTURE(substeps);
    SolverSettings solver;
    solver.substeps = substeps;
    Simulator const simulator(made->densities, Schedule(*made->densities, experiment, solver));
    LaneArray parameters(made->first_start, 1);
    parameters(0, 0) = parameters(1, 0) = 0.5;
    StreamNormals normals({.seed = 6});
    int intervals = 0;
    double held = 0, white = 0;
    ParticleView view;
    view.moved = [&](IntervalMeans const& means) {
      ++intervals;
      for (int w = 0; w < 2000; ++w) {
        held += std::pow(means.values(0, w), 2) / 6000;
        white += std::pow(means.values(1, w), 2) / 6000;
      }
    };
    ParticleFilter(*made, simulator, 2000).run(parameters, normals, view);
    CHECK(intervals == 3);
    // Variances of 6000 numbers: to 1.8 %.
    CHECK(held == doctest::Approx(1).epsilon(0.08));
    CHECK(white * h == doctest::Approx(1).epsilon(0.08));
  }
}

TEST_CASE("particles: what a model remembers goes along with the particle that is chosen") {
  Model model = parsed_model(R"(
model walk {
  input w
  state x
  initial x = 0
  parameter q ~ log_uniform(0.01, 10)
  x' = w
  observe moved ~ normal(since_last(x), sd = 0.3)
}
)");
  disturb(model, "q");
  for (NodeId& memory : model.memories)
    CHECK_FALSE(model.graph.depends(memory, [](Node const& node) { return node.leaf_kind == LeafKind::disturbance; }));
  Experiment experiment;
  experiment.name = "record";
  experiment.time = {0, 0.5, 0.8, 1.6, 2.0};
  experiment.measured = {{0.1, 0.5, -0.3, 0.9, 0.2}};
  experiment.scored.assign(5, 1);
  double const q = 0.7;
  double exact = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    double const variance = 0.09 + (i > 0 ? q * q * (experiment.time[i] - experiment.time[i - 1]) : 0);
    double const r = experiment.measured[0][i];
    exact += -0.5 * (std::log(2 * std::numbers::pi * variance) + r * r / variance);
  }
  Bias const found = bias(*particle_target(model, {experiment}, 64), {q}, exact, 4000, 32);
  MESSAGE("z " << found.z << ", sd of an estimate " << found.relative_sd << " of the likelihood");
  CHECK(std::fabs(found.z) < 3);
}

TEST_CASE("particles: their number is found from the spread of the estimates") {
  Model const model = blown_pendulum();
  auto const target = particle_target(model, {blown_record(60, 0.2)}, 64);
  std::vector<double> precise = pendulum_values;
  precise.back() = 0.02;
  ParticleNeed const need = target->needed(lanes_of(*target, precise, 1), {.seed = 41});
  MESSAGE(need.particles << " particles, sd " << need.sd);
  CHECK(need.particles > 64);
  CHECK(need.particles % 32 == 0);
  CHECK(need.sd < 1.2);
  auto const made = target->with_particles(need.particles);
  double const sd = std::sqrt(sample_variance(estimates(*made, lanes_of(*target, precise, 200), {.seed = 42})));
  CHECK(sd > 0.4);
  CHECK(sd < 1.6);
}

TEST_CASE("particles: what they look like can be seen, and its weights are worth what the outcome says") {
  Model const model = blown_pendulum();
  auto const target = particle_target(model, {blown_record(30, 0.2)}, 400);
  LaneArray const theta = lanes_of(*target, pendulum_values, 1);
  int seen = 0;
  double least = 1, worst = 0;
  FilterOutcome const outcome = target->look(theta, 0, [&](WeighedParticles const& at) {
    ++seen;
    double sum = 0, squares = 0, mean = 0;
    for (std::size_t w = 0; w < at.weights.size(); ++w) {
      sum += at.weights[w];
      squares += at.weights[w] * at.weights[w];
      mean += at.weights[w] * at.states(0, static_cast<int>(w));
    }
    CHECK(sum == doctest::Approx(1));
    least = std::min(least, 1 / (400 * squares));
    worst = std::max(worst, std::fabs(mean / sum - target->experiments()[0].measured[0][static_cast<std::size_t>(at.sample)]));
  });
  CHECK(seen == 29);  // one sample is missing
  CHECK(outcome.log_likelihood == values_of(*target, theta)[0]);
  CHECK(outcome.least_effective == doctest::Approx(least));
  CHECK(worst < 0.3);  // three sds of the noise
}
