// Smoothed states and disturbances: of linear models against the joint normal distribution of all states and samples; of a Duffing
// oscillator against the states that made the records.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "core/numeric/random.hpp"
#include "likelihood/linear_system.hpp"
#include "likelihood/smoothing/pooled_states.hpp"
#include "relative.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

SolverSettings smoothing_solver(std::string const& method, int substeps) {
  SolverSettings solver;
  solver.method = method;
  solver.substeps = substeps;
  return solver;
}

LaneArray column_of(std::vector<double> const& values) {
  LaneArray column(static_cast<int>(values.size()), 1);
  for (std::size_t p = 0; p < values.size(); ++p) column(static_cast<int>(p), 0) = values[p];
  return column;
}

/// Those of the states of a system and of the means of its disturbance between samples, [quantities x samples].
struct Expected {
  Eigen::MatrixXd mean, sd;
};

Expected expected_of(LinearSystem const& system, std::vector<double> const& time, Eigen::MatrixXd const& u,
                     Eigen::MatrixXd const& y) {
  LinearSystem const whole = with_integrals(system);
  auto const n = whole.a.rows(), samples = static_cast<Eigen::Index>(time.size());
  Eigen::MatrixXd functions = Eigen::MatrixXd::Identity(n * samples, n * samples);
  for (Eigen::Index k = 0; k + 1 < samples; ++k)
    for (Eigen::Index s = system.a.rows(); s < n; ++s) {
      double const length = time[static_cast<std::size_t>(k + 1)] - time[static_cast<std::size_t>(k)];
      functions(k * n + s, k * n + s) = -1 / length;
      functions(k * n + s, (k + 1) * n + s) = 1 / length;
    }
  auto const [mean, sd] = posterior_of(joint_normal(whole, time, u, y), functions);
  return {Eigen::Map<Eigen::MatrixXd const>(mean.data(), n, samples), Eigen::Map<Eigen::MatrixXd const>(sd.data(), n, samples)};
}

void check_equal(Smoother::Path const& path, Expected const& expected, double tolerance) {
  REQUIRE(path.solved);
  auto const quantities = expected.mean.rows(), samples = expected.mean.cols();
  REQUIRE(path.mean.size() == static_cast<std::size_t>(quantities * samples));
  double worst_mean = 0, worst_sd = 0;
  for (Eigen::Index q = 0; q < quantities; ++q) {
    Eigen::Index const defined = q + 1 == quantities ? samples - 1 : samples;  // no interval follows the last sample
    double const size = expected.sd.row(q).head(defined).maxCoeff();
    for (Eigen::Index i = 0; i < defined; ++i) {
      auto const place = static_cast<std::size_t>(q * samples + i);
      worst_mean = std::max(worst_mean, std::abs(path.mean[place] - expected.mean(q, i)) / size);
      worst_sd = std::max(worst_sd, std::abs(path.sd[place] - expected.sd(q, i)) / size);
    }
  }
  CHECK(worst_mean < tolerance);
  CHECK(worst_sd < tolerance);
  CHECK(std::isnan(path.mean.back()));
  CHECK(std::isnan(path.sd.back()));
}

/// The start of the model's states with these variances of its first and second parameter-free values.
Model with_random_start(Model model, std::vector<double> const& variances) {
  for (std::size_t s = 0; s < variances.size(); ++s)
    if (variances[s] > 0) model.states[s].initial_variance = model.graph.constant(variances[s]);
  return model;
}

Smoother::Path smoothed_path(Model const& model, FilterRecord const& of, SolverSettings const& solver, FilterRule rule,
                             std::vector<double> const& values) {
  auto const smoothing = compile_smoothing(compile(model, false, solver.method, rule));
  Smoother const smoother(smoothing, of.experiment, solver, 0, {});
  return smoother.run(column_of(values)).front();
}

TEST_CASE("smoothed states of a linear model are those of the joint normal distribution") {
  std::vector<double> const values = {1.3, 4, 130, 0.02, 0.004};
  LinearSystem system = oscillator_system(1.3, 4, 130, 0.02, 0.004);
  Model model = with_disturbance(filtered_file(filtered_text).models.front(), "w", "q");
  SolverSettings solver = smoothing_solver("rk4", 40);
  bool equal_steps = false;
  FilterRule rule = FilterRule::automatic;
  SUBCASE("exact steps") {
    solver = smoothing_solver("exponential", 1);
    equal_steps = true;
  }
  SUBCASE("unequal steps") {}
  SUBCASE("a random start") {
    system.start_covariance = Eigen::Vector2d(4e-6, 1e-3).asDiagonal();
    model = with_random_start(model, {4e-6, 1e-3});
  }
  SUBCASE("a start of which the speed is known") {
    system.start_covariance(0, 0) = 4e-6;
    model = with_random_start(model, {4e-6, 0});
  }
  SUBCASE("steps by their error") {
    solver = smoothing_solver("dopri5", 1);
    solver.relative = 1e-12;
  }
  SUBCASE("sigma points after a known start, of what is linear but in form") {
    std::string text = filtered_text;
    text.replace(text.find("k*y = x"), 7, "k*y + 1e-9 [N/m^3]*y^3 = x");
    model = with_disturbance(filtered_file(text).models.front(), "w", "q");
    rule = FilterRule::unscented;
  }
  SUBCASE("sigma points, of what is linear but in form") {
    std::string text = filtered_text;
    text.replace(text.find("k*y = x"), 7, "k*y + 1e-9 [N/m^3]*y^3 = x");
    model = with_random_start(with_disturbance(filtered_file(text).models.front(), "w", "q"), {4e-6, 1e-3});
    system.start_covariance = Eigen::Vector2d(4e-6, 1e-3).asDiagonal();
    rule = FilterRule::unscented;
  }
  FilterRecord const of = record(60, 2, equal_steps);
  Smoother::Path const path = smoothed_path(model, of, solver, rule, values);
  check_equal(path, expected_of(system, of.experiment.time, of.u, of.y), 1e-9);
}

TEST_CASE("rows that are not scored say nothing of the states") {
  std::vector<double> const values = {1.3, 4, 130, 0.02, 0.004};
  LinearSystem const system = oscillator_system(1.3, 4, 130, 0.02, 0.004);
  FilterRecord of = record(60, 2, false);
  for (int i = 20; i < 40; ++i) {
    of.experiment.scored[static_cast<std::size_t>(i)] = 0;
    of.y.col(i).setConstant(std::nan(""));
  }
  Model const model = with_disturbance(filtered_file(filtered_text).models.front(), "w", "q");
  Smoother::Path const path = smoothed_path(model, of, smoothing_solver("rk4", 40), FilterRule::automatic, values);
  check_equal(path, expected_of(system, of.experiment.time, of.u, of.y), 1e-9);
  CHECK(path.sd[30] > 1.5 * path.sd[10]);
}

TEST_CASE("a state that other states determine is smoothed with them") {
  // The third state integrates the first and starts known, so that its covariance is singular until the noise has come to it.
  std::string text = filtered_text;
  text.replace(text.find("  state y [m]"), 13, "  state y [m], z [m s]\n  initial z = 0");
  text.replace(text.find("  observe displacement"), 22, "  z' = y\n  observe displacement");
  Model const model = with_disturbance(filtered_file(text).models.front(), "w", "q");
  std::vector<std::string> names;
  for (State const& state : model.states) names.push_back(state.name);
  REQUIRE(names == std::vector<std::string>{"y", "y'", "z"});
  LinearSystem system = oscillator_system(1.3, 4, 130, 0.02, 0.004);
  system.a = Eigen::Matrix3d{{0, 1, 0}, {-100, -4 / 1.3, 0}, {1, 0, 0}};
  system.b = system.g = Eigen::Vector3d(0, 1 / 1.3, 0);
  system.h = Eigen::MatrixXd{{1, 0, 0}, {0.5, 1, 0}};
  system.start = Eigen::Vector3d(0.005, 0, 0);
  system.start_covariance = Eigen::Matrix3d::Zero();
  FilterRecord const of = record(60, 2, true);
  Smoother::Path const path =
      smoothed_path(model, of, smoothing_solver("exponential", 1), FilterRule::automatic, {1.3, 4, 130, 0.02, 0.004});
  check_equal(path, expected_of(system, of.experiment.time, of.u, of.y), 1e-7);
}

TEST_CASE("of five masses one is seen, and the force acts on the last") {
  std::string const text = R"(
model chain {
  input x [N], w [N]
  state y1 [m], y2 [m], y3 [m], y4 [m], y5 [m]
  initial y1 = 0, y1' = 0, y2 = 0, y2' = 0, y3 = 0, y3' = 0, y4 = 0, y4' = 0, y5 = 0, y5' = 0
  parameter q [N^2 s] ~ log_uniform(1e-6, 1)
  parameter k [N/m] ~ log_uniform(1, 1e6)
  1 [kg]*y1'' + 0.5 [N s/m]*y1' + k*(2*y1 - y2) = x
  1 [kg]*y2'' + 0.5 [N s/m]*y2' + k*(2*y2 - y1 - y3) = 0
  1 [kg]*y3'' + 0.5 [N s/m]*y3' + k*(2*y3 - y2 - y4) = 0
  1 [kg]*y4'' + 0.5 [N s/m]*y4' + k*(2*y4 - y3 - y5) = 0
  1 [kg]*y5'' + 0.5 [N s/m]*y5' + k*(y5 - y4) = w
  observe first ~ normal(y1, sd = 4 [mm])
}
)";
  Model const model = with_disturbance(filtered_file(text).models.front(), "w", "q");
  LinearSystem system;
  system.a = Eigen::MatrixXd::Zero(10, 10);
  system.b = system.g = Eigen::MatrixXd::Zero(10, 1);
  system.h = Eigen::MatrixXd::Zero(1, 10);
  auto const place = [&](std::string const& name) {
    for (std::size_t s = 0; s < model.states.size(); ++s)
      if (model.states[s].name == name) return static_cast<Eigen::Index>(s);
    FAIL(name);
    return Eigen::Index{0};
  };
  for (int i = 1; i <= 5; ++i) {
    auto const at = [&](int mass) { return place("y" + std::to_string(mass)); };
    Eigen::Index const speed = place("y" + std::to_string(i) + "'");
    system.a(at(i), speed) = 1;
    system.a(speed, speed) = -0.5;
    system.a(speed, at(i)) = i == 5 ? -100 : -200;
    if (i > 1) system.a(speed, at(i - 1)) = 100;
    if (i < 5) system.a(speed, at(i + 1)) = 100;
  }
  system.b(place("y1'"), 0) = system.g(place("y5'"), 0) = 1;
  system.h(0, place("y1")) = 1;
  system.start = Eigen::VectorXd::Zero(10);
  system.start_covariance = Eigen::MatrixXd::Zero(10, 10);
  system.q = Eigen::MatrixXd::Constant(1, 1, 0.5);
  system.r = Eigen::MatrixXd::Constant(1, 1, 1.6e-5);
  FilterRecord const of = record(60, 1, true);
  Smoother::Path const path = smoothed_path(model, of, smoothing_solver("rk4", 10), FilterRule::automatic, {0.5, 100});
  // The noise reaches the first mass by nine integrations: after one interval the covariance is singular to rounding.
  check_equal(path, expected_of(system, of.experiment.time, of.u, of.y), 2e-5);
}

TEST_CASE("a disturbance in discrete time is smoothed as the joint normal distribution has it") {
  std::string const text = R"(
model ar {
  time discrete 0.02 [s]
  input x [N]
  state y [m]
  initial y = 0
  parameter a ~ uniform(0, 1)
  parameter s [m] ~ log_uniform(1e-5, 1)
  disturbance w [m] ~ normal(0, sd = s)
  y = a*lag(y, 1) + 0.001 [m/N]*x + w
  observe displacement ~ normal(y, sd = 2 [mm])
  derive present [mm] = y
}
)";
  constexpr int samples = 40;
  constexpr double a = 0.8, s = 0.004, r = 0.002;
  Model const model = filtered_file(text).models.front();
  FilterRecord const of = record(samples, 1, true);
  Eigen::MatrixXd responses = Eigen::MatrixXd::Zero(samples, samples);  // of y to w
  for (int k = 0; k < samples; ++k)
    for (int j = 0; j <= k; ++j) responses(k, j) = std::pow(a, k - j);
  JointNormal joint;
  joint.mean = Eigen::VectorXd::Zero(samples);
  joint.covariance = s * s * Eigen::MatrixXd::Identity(samples, samples);
  Eigen::VectorXd const known = responses * (0.001 * of.u.row(0).transpose());
  std::vector<int> seen;
  for (int k = 0; k < samples; ++k)
    if (!std::isnan(of.y(0, k))) seen.push_back(k);
  joint.observation = responses(seen, Eigen::all);
  joint.left = of.y.row(0).transpose()(seen) - known(seen);
  joint.of_samples = joint.observation * joint.covariance * joint.observation.transpose();
  joint.of_samples.diagonal().array() += r * r;
  Eigen::MatrixXd functions(2 * samples, samples);
  functions << Eigen::MatrixXd::Identity(samples, samples), responses;
  auto const [mean, sd] = posterior_of(joint, functions);

  auto const smoothing = compile_smoothing(compile(model, false, "rk4", FilterRule::automatic));
  Smoother const smoother(smoothing, of.experiment, smoothing_solver("rk4", 1), 0, {});
  std::vector<std::string> names;
  for (SmoothedName const& each : smoother.quantities()) names.push_back(each.name);
  REQUIRE(names == std::vector<std::string>{"w", "present", "y"});
  CHECK_FALSE(smoother.quantities()[0].average);
  Smoother::Path const path = smoother.run(column_of({a, s})).front();
  for (Eigen::Index i = 0; i < samples; ++i) {
    auto const at = static_cast<std::size_t>(i);
    CHECK(std::abs(path.mean[at] - mean(i)) < 1e-9 * s);
    CHECK(std::abs(path.sd[at] - sd(i)) < 1e-9 * s);
    CHECK(path.mean[samples + at] == doctest::Approx(1e3 * (mean(samples + i) + known(i))).epsilon(1e-9));
    CHECK(path.sd[samples + at] == doctest::Approx(1e3 * sd(samples + i)).epsilon(1e-9));
  }
}

TEST_CASE("quantities derived from smoothed states have their sds to first order") {
  std::string text = filtered_text;
  text.replace(text.find("  observe displacement"), 22, "  derive spring [N] = k*y + x\n  observe displacement");
  Model const model = with_disturbance(filtered_file(text).models.front(), "w", "q");
  FilterRecord const of = record(60, 2, false);
  auto const smoothing = compile_smoothing(compile(model, false, "rk4", FilterRule::automatic));
  Smoother const smoother(smoothing, of.experiment, smoothing_solver("rk4", 4), 0, {});
  std::vector<std::string> names, units;
  for (SmoothedName const& each : smoother.quantities()) names.push_back(each.name), units.push_back(each.unit);
  CHECK(names == std::vector<std::string>{"y", "y'", "w", "spring"});
  CHECK(units[0] == "m");
  CHECK(units[2] == "N");
  CHECK(units[3] == "N");
  Smoother::Path const path = smoother.run(column_of({1.3, 4, 130, 0.02, 0.004})).front();
  for (std::size_t i = 0; i < 60; ++i) {
    CHECK(path.mean[3 * 60 + i] == relative(130 * path.mean[i] + of.u(0, static_cast<Eigen::Index>(i)), 1e-12));
    CHECK(path.sd[3 * 60 + i] == relative(130 * path.sd[i], 1e-12));
  }
}

TEST_CASE("smoothed states are the same bytes for any lanes, threads and executor, alone or among others") {
  std::string text = filtered_text;
  text.replace(text.find("k*y = x"), 7, "k*y + 4e5 [N/m^3]*y^3 = x");
  Model const model = with_disturbance(filtered_file(text).models.front(), "w", "q");
  FilterRecord const of = record(60, 2, false);
  LaneArray values(5, 20);
  for (int w = 0; w < 20; ++w) {
    double const at[] = {1.3, 4, 130, 0.02, 0.004};
    for (int p = 0; p < 5; ++p) values(p, w) = at[p] * (1 + 0.01 * w * (p + 1));
  }
  for (FilterRule const rule : {FilterRule::extended, FilterRule::unscented}) {
    auto const smoothing = compile_smoothing(compile(model, false, "rk4", rule));
    auto const run = [&](ExecutionOptions const& execution, ConstLanes of_values) {
      return Smoother(smoothing, of.experiment, smoothing_solver("rk4", 2), 0, execution).run(of_values);
    };
    auto const one = run({.lanes = 1}, values), wide = run({.lanes = 16, .threads = 2}, values);
    auto const native = run({.lanes = 8, .executor = ExecutorKind::native}, values);
    auto const alone = run({}, values.view().columns(7, 1));
    // The last interval's mean is NaN, which equals nothing.
    auto const same = [](Smoother::Path const& a, Smoother::Path const& b) {
      auto const equal = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
      return a.solved && b.solved && std::ranges::equal(a.mean, b.mean, equal) && std::ranges::equal(a.sd, b.sd, equal);
    };
    for (std::size_t w = 0; w < 20; ++w) {
      CHECK(same(one[w], wide[w]));
      CHECK(same(one[w], native[w]));
    }
    CHECK(same(one[7], alone[0]));
  }
}

TEST_CASE("bands of smoothed states hold both what parameters and what states leave open") {
  Model const model = with_disturbance(filtered_file(filtered_text).models.front(), "w", "q");
  FilterRecord const of = record(60, 2, false);
  auto const smoothing = compile_smoothing(compile(model, false, "rk4", FilterRule::automatic));
  Smoother const smoother(smoothing, of.experiment, smoothing_solver("rk4", 4), 0, {});
  LaneArray values(5, 3);
  for (int w = 0; w < 3; ++w) {
    double const at[] = {1.3, 4, 130 + 40.0 * w, 0.02, w == 2 ? std::nan("") : 0.004};
    for (int p = 0; p < 5; ++p) values(p, w) = at[p];
  }
  auto const paths = smoother.run(values);
  CHECK_FALSE(paths[2].solved);
  std::vector<Band> const bands = pooled_states(smoother, values);
  REQUIRE(bands.size() == 3);
  CHECK(bands[0].draws == 3);
  CHECK(bands[0].excluded == 1);
  for (std::size_t i = 1; i < 60; ++i) {
    double const a = paths[0].mean[i], b = paths[1].mean[i];
    CHECK(bands[0].mean[i] == relative((a + b) / 2, 1e-12));
    double const variance = (a - b) * (a - b) / 4 + (paths[0].sd[i] * paths[0].sd[i] + paths[1].sd[i] * paths[1].sd[i]) / 2;
    CHECK(bands[0].sd[i] == relative(std::sqrt(variance), 1e-12));
    double below = 0;
    for (std::size_t w = 0; w < 2; ++w)
      below += 0.25 * std::erfc(-(bands[0].upper[i] - paths[w].mean[i]) / paths[w].sd[i] / std::sqrt(2));
    CHECK(below == doctest::Approx(0.975).epsilon(1e-9));
  }
  CHECK(bands[0].lower[0] == 0.005);  // the known start
  CHECK(bands[0].upper[0] == 0.005);
  CHECK(std::isnan(bands[2].mean.back()));
}

TEST_CASE("quantiles of a mixture of normal distributions") {
  CHECK(normal_mixture_quantile({2}, {3}, 0.975) == doctest::Approx(2 + 3 * 1.959963984540054).epsilon(1e-12));
  CHECK(normal_mixture_quantile({1, 1}, {0, 0}, 0.025) == 1);
  CHECK(normal_mixture_quantile({-1, 1}, {0.5, 0.5}, 0.5) == doctest::Approx(0).epsilon(1e-10));
  // Of steps the place of one, and with a narrow and a distant wide part.
  CHECK(normal_mixture_quantile({0, 1, 2}, {0, 0, 0}, 0.5) == doctest::Approx(1).epsilon(1e-9));
  double const x = normal_mixture_quantile({0, 1e6}, {1e-6, 1e3}, 0.3);
  CHECK(0.25 * std::erfc(-x / 1e-6 / std::sqrt(2)) == doctest::Approx(0.3).epsilon(1e-6));
}

/// m y'' + c y' + k y + k3 y^3 = x + w, with w white or of Ornstein and Uhlenbeck, by many small steps.
struct DuffingRecord {
  FilterRecord record;
  Eigen::MatrixXd truth;  // y, y', and the mean of w from each sample to the next, or w there
};

DuffingRecord duffing_record(std::uint64_t seed, bool white, int samples) {
  constexpr double m = 1, c = 1, k = 100, k3 = 2e4, sigma = 0.002, step = 0.02, q = 0.05, sd = 1.5, memory = 0.3;
  constexpr int parts = 200;
  Stream stream({seed, Purpose::test, 0, 0});
  DuffingRecord result;
  result.record = record(samples, 1, true);
  result.truth = Eigen::MatrixXd::Zero(3, samples);
  double const h = step / parts;
  double y = 0, v = 0, w = 0;
  for (int i = 0; i < samples; ++i) {
    result.record.experiment.measured[0][static_cast<std::size_t>(i)] = y + sigma * stream.normal();
    result.truth(0, i) = y;
    result.truth(1, i) = v;
    if (!white) result.truth(2, i) = w;
    for (int part = 0; part < parts; ++part) {
      double const force = white ? std::sqrt(q / h) * stream.normal() : w;
      if (white) result.truth(2, i) += force / parts;
      auto const acceleration = [&](double at, double speed) {
        return (5 * result.record.u(0, i) + force - c * speed - k * at - k3 * at * at * at) / m;
      };
      double const half_y = y + 0.5 * h * v, half_v = v + 0.5 * h * acceleration(y, v);
      y += h * half_v;
      v += h * acceleration(half_y, half_v);
      if (!white) w += -h * w / memory + std::sqrt(2 * sd * sd * h / memory) * stream.normal();
    }
  }
  return result;
}

std::string const duffing_text = R"(
model duffing {
  input x [N], w [N]
  state y [m]
  initial y = 0, y' = 0
  parameter k3 [N/m^3] ~ log_uniform(1, 1e6)
  parameter q [N^2 s] ~ log_uniform(1e-6, 1)
  1 [kg]*y'' + 1 [N s/m]*y' + 100 [N/m]*y + k3*y^3 = 5*x + w
  observe displacement [m] ~ normal(y, sd = 0.002)
}
)";

std::string const coloured_text = R"(
model duffing {
  input x [N], n [N/s]
  state y [m], w [N]
  initial y = 0, y' = 0, w = 0
  parameter k3 [N/m^3] ~ log_uniform(1, 1e6)
  parameter q [N^2/s] ~ log_uniform(1e-6, 100)
  1 [kg]*y'' + 1 [N s/m]*y' + 100 [N/m]*y + k3*y^3 = 5*x + w
  w' = -w/0.3 [s] + n
  observe displacement [m] ~ normal(y, sd = 0.002)
}
)";

TEST_CASE("smoothed states hold the true ones as often as they say") {
  bool white = true;
  FilterRule rule = FilterRule::extended;
  SUBCASE("white force, extended") {}
  SUBCASE("white force, unscented") { rule = FilterRule::unscented; }
  SUBCASE("force with a memory") { white = false; }
  Model const model = white ? with_disturbance(filtered_file(duffing_text).models.front(), "w", "q")
                            : with_disturbance(filtered_file(coloured_text).models.front(), "n", "q");
  constexpr int samples = 200;
  auto const smoothing = compile_smoothing(compile(model, false, "rk4", rule));
  std::vector<double> inside(3), all(3);
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    DuffingRecord const made = duffing_record(seed, white, samples);
    Smoother const smoother(smoothing, made.record.experiment, smoothing_solver("rk4", 4), 0, {});
    Smoother::Path const path = smoother.run(column_of({2e4, white ? 0.05 : 2 * 1.5 * 1.5 / 0.3})).front();
    REQUIRE(path.solved);
    for (std::size_t q = 0; q < 3; ++q)
      for (std::size_t i = 1; i + 1 < samples; ++i) {
        double const off = path.mean[q * samples + i] - made.truth(static_cast<Eigen::Index>(q), static_cast<Eigen::Index>(i));
        inside[q] += std::abs(off) < 1.96 * path.sd[q * samples + i] ? 1 : 0;
        ++all[q];
      }
  }
  for (std::size_t q = 0; q < 3; ++q) {
    CAPTURE(q);
    CHECK(inside[q] / all[q] > 0.93);
    CHECK(inside[q] / all[q] < 0.97);
  }
}

}  // namespace
