// The exact step against closed forms, against adaptive steps of small tolerance, and its derivatives against differences.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "core/numeric/random.hpp"
#include "core/text/diagnostic.hpp"
#include "program/tangents.hpp"
#include "relative.hpp"
#include "simulate/experiments.hpp"
#include "simulate/simulator.hpp"
#include "simulate/systems.hpp"

using namespace sysid;

namespace exponential_tests {
namespace {

/// m y'' + c y' + k y = x from y0, v0; parameters m, c, k, y0, v0; records y, y'.
SimulationSource oscillator(std::string integrator = "exponential") {
  SimulationSource source;
  Graph& g = source.graph;
  auto const p = [&](int i) { return g.leaf(LeafKind::parameter, i); };
  NodeId const y = g.leaf(LeafKind::state, 0), v = g.leaf(LeafKind::state, 1), x = g.leaf(LeafKind::input, 0);
  source.parameters = 5;
  source.inputs = 1;
  source.initial = {p(3), p(4)};
  source.derivative = {v, g.divide(g.subtract(x, g.add(g.multiply(p(1), v), g.multiply(p(2), y))), p(0))};
  source.records = {y, v};
  source.integrator = std::move(integrator);
  return source;
}

/// tau_1 y_1' = x - y_1,  tau_2 y_2' = y_1 - y_2, from 0; parameters tau_1, tau_2.
SimulationSource two_lags() {
  SimulationSource source;
  Graph& g = source.graph;
  NodeId const y = g.leaf(LeafKind::state, 0), z = g.leaf(LeafKind::state, 1), x = g.leaf(LeafKind::input, 0);
  source.parameters = 2;
  source.inputs = 1;
  source.initial = {g.constant(0), g.constant(0)};
  source.derivative = {g.divide(g.subtract(x, y), g.leaf(LeafKind::parameter, 0)),
                       g.divide(g.subtract(y, z), g.leaf(LeafKind::parameter, 1))};
  source.records = {y, z};
  source.integrator = "exponential";
  return source;
}

struct Run {
  std::vector<double> values;  // records of all samples
  bool ok;
};

Run simulated(SimulationSource const& source, Experiment const& record, std::vector<double> const& parameters,
              SolverSettings solver = {}) {
  auto const program = std::make_shared<SimulationProgram const>(compile(source));
  solver.method = source.integrator;
  Simulator const simulator(program, Schedule(*program, record, solver));
  LaneArray column(static_cast<int>(parameters.size()), 1);
  for (std::size_t p = 0; p < parameters.size(); ++p) column(static_cast<int>(p), 0) = parameters[p];
  int const samples = static_cast<int>(record.time.size());
  LaneArray out(samples * program->registers.records, 1);
  Outcome outcome;
  simulator.records(column, 0, samples, out, {&outcome, 1});
  return {{out.view().data(), out.view().data() + out.rows()}, outcome.ok};
}

Experiment record_at(std::vector<double> time, std::function<double(double)> const& input, InputRule rule = InputRule::linear) {
  return testing::experiment(std::move(time), {input}, {}, rule);
}

Experiment record(int samples, double step, std::function<double(double)> const& input, InputRule rule = InputRule::linear) {
  return testing::experiment(testing::uniform_times(samples, step), {input}, {}, rule);
}

/// Largest error of record 0, as a part of its largest value.
double worst(Run const& run, int records, std::vector<double> const& time, std::function<double(double)> const& exact) {
  double error = 0, size = 0;
  for (std::size_t i = 0; i * static_cast<std::size_t>(records) < run.values.size(); ++i) {
    double const expected = exact(time[i]);
    error = std::max(error, std::abs(run.values[i * static_cast<std::size_t>(records)] - expected));
    size = std::max(size, std::abs(expected));
  }
  return error / size;
}

double worst(Run const& run, int records, double step, std::function<double(double)> const& exact) {
  return worst(run, records, testing::uniform_times(static_cast<int>(run.values.size()), step), exact);
}

double none(double) { return 0; }
double one(double) { return 1; }
double ramp(double t) { return t; }

}  // namespace

// Of underdamped oscillators: Inman, Engineering Vibration, section 3.2, and its integral over time.
TEST_CASE("an oscillator follows its step, its ramp and its free response, however long the step") {
  double const m = 0.7, k = 28, w = std::sqrt(k / m);
  for (double const zeta : {0.02, 0.3})
    for (double const step : {0.001, 0.1, 1.0, 7.0}) {
      CAPTURE(zeta);
      CAPTURE(step);
      double const c = 2 * zeta * w * m, d = zeta * w, wd = w * std::sqrt(1 - zeta * zeta);
      auto const stepped = [&](double t) { return (1 - std::exp(-d * t) * (std::cos(wd * t) + d / wd * std::sin(wd * t))) / k; };
      auto const ramped = [&](double t) {
        double const s = 2 * zeta / w;
        return (t - s + std::exp(-d * t) * (s * std::cos(wd * t) + (2 * zeta * zeta - 1) / wd * std::sin(wd * t))) / k;
      };
      auto const released = [&](double t) {
        return std::exp(-d * t) * (0.3 * std::cos(wd * t) + (-0.2 + d * 0.3) / wd * std::sin(wd * t));
      };
      SimulationSource const source = oscillator();
      for (InputRule const rule : {InputRule::linear, InputRule::zero_order})
        CHECK(worst(simulated(source, record(60, step, &one, rule), {m, c, k, 0, 0}), 2, step, stepped) < 2e-13);
      CHECK(worst(simulated(source, record(60, step, &ramp), {m, c, k, 0, 0}), 2, step, ramped) < 2e-13);
      CHECK(worst(simulated(source, record(60, step, &none), {m, c, k, 0.3, -0.2}), 2, step, released) < 2e-13);
    }
}

TEST_CASE("matrices that are defective or singular take no other way") {
  double const m = 2, step = 0.3;
  SimulationSource const source = oscillator();
  double const w = 3, y0 = 0.4, v0 = -0.1;
  CHECK(worst(simulated(source, record(40, step, &none), {m, 2 * m * w, m * w * w, y0, v0}), 2, step,
              [&](double t) { return (y0 + (v0 + w * y0) * t) * std::exp(-w * t); }) < 1e-13);
  CHECK(worst(simulated(source, record(40, step, &one), {m, 0, 0, y0, v0}), 2, step,
              [&](double t) { return y0 + v0 * t + t * t / (2 * m); }) < 1e-13);
  CHECK(worst(simulated(source, record(40, step, &ramp), {m, 0, 0, 0, 0}), 2, step, [&](double t) { return t * t * t / (6 * m); }) <
        1e-13);
  double const c = 0.9, rest = m / c;
  CHECK(worst(simulated(source, record(40, step, &one), {m, c, 0, 0, 0}), 2, step,
              [&](double t) { return (t - rest * (1 - std::exp(-t / rest))) / c; }) < 1e-13);
}

TEST_CASE("time constants decades below the samples, beside slow ones") {
  double const step = 1;
  for (double const slow : {1e-3, 3.0, 50.0})
    for (double const fast : {0.1, 1e-3 * 1.7, 1e-5}) {
      CAPTURE(slow);
      CAPTURE(fast);
      auto const response = [&](double t) {
        return t - fast - slow + (slow * slow * std::exp(-t / slow) - fast * fast * std::exp(-t / fast)) / (slow - fast);
      };
      Run const run = simulated(two_lags(), record(50, step, &ramp), {fast, slow});
      REQUIRE(run.ok);
      Run shifted = run;
      shifted.values.erase(shifted.values.begin());
      // A matrix is known to its rounding, relative to its largest entry.
      CHECK(worst(shifted, 2, step, response) < 1e-13 + 4e-15 / fast);
    }
}

TEST_CASE("an oscillator and two lags follow their closed forms along unequal steps") {
  double const m = 0.7, k = 28, zeta = 0.02, w = std::sqrt(k / m), c = 2 * zeta * w * m, d = zeta * w;
  double const wd = w * std::sqrt(1 - zeta * zeta);
  auto const stepped = [&](double t) { return (1 - std::exp(-d * t) * (std::cos(wd * t) + d / wd * std::sin(wd * t))) / k; };
  for (double const step : {0.001, 0.1, 7.0}) {
    CAPTURE(step);
    std::vector<double> const time = testing::unequal_times(300, step);
    for (InputRule const rule : {InputRule::linear, InputRule::zero_order})
      CHECK(worst(simulated(oscillator(), record_at(time, &one, rule), {m, c, k, 0, 0}), 2, time, stepped) < 4e-13);
    double const fast = 1e-3 * step, slow = 40 * step;
    auto const second = [&](double t) {
      return t - fast - slow + (slow * slow * std::exp(-t / slow) - fast * fast * std::exp(-t / fast)) / (slow - fast);
    };
    Run run = simulated(two_lags(), record_at(time, &ramp), {fast, slow});
    run.values.erase(run.values.begin());
    CHECK(worst(run, 2, time, second) < 1e-11);
  }
}

TEST_CASE("lengths of steps are told apart beyond rounding, the most frequent first") {
  std::vector<double> time{1e6};
  for (int i = 0; i < 40; ++i) time.push_back(time.back() + (i % 4 == 3 ? 0.7 : 0.1));
  StepLengths const two = step_lengths(time);
  REQUIRE(two.count() == 2);
  CHECK(two.values[0] == relative(0.1, 1e-8));
  CHECK(two.values[1] == doctest::Approx(0.7).epsilon(1e-8));
  CHECK(two.of[2] == 0);
  CHECK(two.of[3] == 1);
  CHECK(two.until[0] == 3);
  CHECK(two.until[3] == 4);
  CHECK(two.until[40] == 41);
  CHECK(step_lengths(testing::uniform_times(30, 0.1)).count() == 1);
  CHECK(step_lengths(testing::unequal_times(30, 0.1)).count() > 20);
}

// 1.2 parts in a million from the mean of the part, 0.9 from that of the whole.
TEST_CASE("a part of a record whose steps are equal is stepped by their mean") {
  std::vector<double> time{0};
  for (int i = 1; i < 200; ++i) time.push_back(time.back() + (i < 100 ? 1 + 0.9e-6 : 1 - 0.9e-6));
  REQUIRE(unequal_step(time) == 0);
  time.resize(150);
  REQUIRE(unequal_step(time) > 0);
  CHECK(step_lengths(time).count() == 1);
  time.back() += 1e-3;
  CHECK(step_lengths(time).count() == 3);
}

// Such an entry is as large as the units make it, and how fast powers of the matrix grow does not depend on it.
TEST_CASE("a gain on the way from one state to another does not count for the reach") {
  for (double const gain : {1e-15, 1e15, 1e30}) {
    CAPTURE(gain);
    SimulationSource source = two_lags();
    Graph& g = source.graph;
    NodeId const y = g.leaf(LeafKind::state, 0), z = g.leaf(LeafKind::state, 1);
    source.derivative[1] = g.divide(g.subtract(g.multiply(g.constant(gain), y), z), g.leaf(LeafKind::parameter, 1));
    Run const run = simulated(source, record(30, 0.2, &one), {0.5, 2}),
              plain = simulated(two_lags(), record(30, 0.2, &one), {0.5, 2});
    REQUIRE(run.ok);
    for (std::size_t i = 1; i < plain.values.size(); i += 2) CHECK(run.values[i] / gain == relative(plain.values[i], 1e-13));
  }
}

TEST_CASE("a matrix beyond the reach of the series fails, and never gives a wrong number") {
  int failed = 0, right = 0;
  for (double rate = 1e-6; rate < 1e12; rate *= 3.7) {
    CAPTURE(rate);
    Run const lag = simulated(two_lags(), record(3, 1, &one), {1 / rate, 0.5});
    Run const free = simulated(oscillator(), record(3, 1, &none), {1, 0, rate * rate, 1, 0});
    (lag.ok ? right : failed) += 1;
    if (lag.ok) CHECK(lag.values[2] == relative(-std::expm1(-rate), 1e-9));
    // cos: of a phase that is known to its rounding.
    if (free.ok) CHECK(std::abs(free.values[2] - std::cos(rate)) < 1e-13 + 3e-15 * rate);
    // 2^29 by sampling step.
    CHECK(lag.ok == (rate < 5.3e8));
    CHECK(free.ok == (rate < 5.3e8));
  }
  CHECK(failed > 5);
  CHECK(right > 10);
  CHECK_FALSE(simulated(two_lags(), record(3, 1, &one), {1e-12, 0.5}).ok);
  CHECK_FALSE(simulated(oscillator(), record(3, 1, &none), {1, -2000, 1, 1, 0}).ok);  // grows beyond all numbers
  CHECK_FALSE(simulated(oscillator(), record(3, 1, &none), {0, 1, 1, 1, 0}).ok);
}

namespace {

/// x' = A x + B u + c u_1' + d of n states and two inputs; parameters: A, B, c, d row by row, then the first states.
struct Random {
  SimulationSource source;
  std::vector<double> parameters;
};

Random random_system(int n, Stream& stream, std::string const& integrator) {
  Random result;
  Graph& g = result.source.graph;
  auto const parameter = [&](double value) {
    result.parameters.push_back(value);
    return g.leaf(LeafKind::parameter, static_cast<int>(result.parameters.size()) - 1);
  };
  std::vector<double> const skew = [&] {
    std::vector<double> values(static_cast<std::size_t>(n * n));
    for (double& each : values) each = 2 * stream.normal();
    return values;
  }();
  for (int i = 0; i < n; ++i) {
    NodeId rate = parameter(0.1 * stream.normal());
    for (int j = 0; j < n; ++j) {
      double const twist =
          i == j ? -0.3 - stream.uniform() : skew[static_cast<std::size_t>(i * n + j)] - skew[static_cast<std::size_t>(j * n + i)];
      if (i == j || stream.below(3) > 0) rate = g.add(rate, g.multiply(parameter(twist), g.leaf(LeafKind::state, j)));
    }
    for (int k = 0; k < 2; ++k) rate = g.add(rate, g.multiply(parameter(stream.normal()), g.leaf(LeafKind::input, k)));
    rate = g.add(rate, g.multiply(parameter(0.1 * stream.normal()), g.leaf(LeafKind::input_rate, 0)));
    result.source.derivative.push_back(rate);
    result.source.records.push_back(g.leaf(LeafKind::state, i));
  }
  for (int i = 0; i < n; ++i) result.source.initial.push_back(parameter(stream.normal()));
  result.source.parameters = static_cast<int>(result.parameters.size());
  result.source.inputs = 2;
  result.source.integrator = integrator;
  return result;
}

double sine(double t) { return std::sin(5 * t); }
double cosine(double t) { return std::cos(1.7 * t) + 0.2; }

}  // namespace

TEST_CASE("random systems of up to eight states agree with adaptive steps") {
  for (std::uint64_t index = 0; index < 24; ++index) {
    CAPTURE(index);
    StreamKey const key{.seed = 31, .purpose = Purpose::test, .index = index, .step = 0};
    int const n = 1 + static_cast<int>(index % 8);
    std::vector<double> const time = index % 3 == 0 ? testing::unequal_times(30, 0.1) : testing::uniform_times(30, 0.1);
    Experiment const two = testing::experiment(time, {&sine, &cosine}, {});
    Stream first(key), second(key);
    Random const exact = random_system(n, first, "exponential"), adaptive = random_system(n, second, "dopri5");
    Run const found = simulated(exact.source, two, exact.parameters);
    Run const expected =
        simulated(adaptive.source, two, adaptive.parameters, {.relative = 1e-12, .absolute = 1e-13, .steps = 100000});
    REQUIRE(expected.ok);
    REQUIRE(found.ok);
    double size = 1, error = 0;
    for (std::size_t i = 0; i < found.values.size(); ++i) {
      size = std::max(size, std::abs(expected.values[i]));
      error = std::max(error, std::abs(found.values[i] - expected.values[i]));
    }
    CHECK(error < 2e-10 * size);
  }
}

TEST_CASE("tangents of an exact step are what differences tend to") {
  Experiment made = testing::experiment(testing::uniform_times(40, 0.02), {&sine}, {&cosine});
  SimulationSource const source = systems::linear_chain(2);
  std::vector<double> const centre = {1, 2, 400, 410, 30};
  std::vector<int> const by = {0, 1, 2, 3, 4};
  SimulationSource plain = source, tangent = with_gradient(source, by);
  plain.records.clear();
  auto const sums = [&](SimulationSource const& of, std::vector<double> const& parameters) {
    auto const program = std::make_shared<SimulationProgram const>(compile(of));
    Simulator const simulator(program, Schedule(*program, made, {.method = "exponential"}));
    LaneArray column(5, 1), out(program->sum_count(), 1);
    for (int p = 0; p < 5; ++p) column(p, 0) = parameters[static_cast<std::size_t>(p)];
    Outcome outcome;
    simulator.sums(column, out, {&outcome, 1});
    REQUIRE(outcome.ok);
    return std::vector<double>(out.view().data(), out.view().data() + out.rows());
  };
  std::vector<double> const derivatives = sums(tangent, centre);
  CHECK(derivatives[0] == sums(plain, centre)[0]);
  for (int const p : by) {
    CAPTURE(p);
    auto const at = [&](double part) {
      std::vector<double> moved = centre;
      moved[static_cast<std::size_t>(p)] *= 1 + part;
      return sums(plain, moved)[0];
    };
    double const h = 1e-3, near = (at(h) - at(-h)) / (2 * h), far = (at(2 * h) - at(-2 * h)) / (4 * h);
    double const expected = (4 * near - far) / 3 / centre[static_cast<std::size_t>(p)];
    CHECK(derivatives[static_cast<std::size_t>(1 + p)] == relative(expected, 1e-7));
  }
}

TEST_CASE("records of different steps share a program, and a remembered sample stays as it is") {
  auto const program = std::make_shared<SimulationProgram const>(compile(oscillator()));
  for (double const step : {0.01, 0.5}) {
    Experiment const made = record(20, step, &one);
    Simulator const simulator(program, Schedule(*program, made, {.method = "exponential"}));
    LaneArray parameters(5, 1), out(2, 1);
    double const values[] = {1, 0, 4, 0, 0};
    for (int p = 0; p < 5; ++p) parameters(p, 0) = values[p];
    Outcome outcome;
    simulator.records(parameters, 19, 20, out, {&outcome, 1});
    CHECK(out(0, 0) == relative((1 - std::cos(2 * 19 * step)) / 4, 1e-12));
  }
}

TEST_CASE("what an exact step does not suit is no schedule, and no program") {
  SimulationProgram const program = compile(oscillator());
  SolverSettings const solver{.method = "exponential"};
  CHECK_NOTHROW(Schedule(program, record(10, 0.1, &one), solver));
  CHECK_NOTHROW(Schedule(program, testing::experiment({0, 0.1, 0.2 + 1e-8, 0.3}, {&one}, {}), solver));
  CHECK_NOTHROW(Schedule(program, testing::experiment({0, 0.1, 0.21, 0.3}, {&one}, {}), solver));
  CHECK_THROWS_AS(Schedule(program, record(10, 0.1, &one, InputRule::cubic), solver), InternalError);
  SimulationSource source = systems::duffing();
  source.integrator = "exponential";
  CHECK_THROWS_AS(compile(std::move(source)), InternalError);
}

}  // namespace exponential_tests
