// Solvers that choose their own steps: against closed forms and against each other, over tolerances, lanes and threads; algebraic
// states; classes of failure.
#include <doctest/doctest.h>

#include <atomic>
#include <bit>
#include <cmath>
#include <string>

#include "core/numeric/random.hpp"
#include "core/system/interrupt.hpp"
#include "relative.hpp"
#include "simulate/experiments.hpp"
#include "simulate/simulator.hpp"
#include "simulate/systems.hpp"

using namespace sysid;

namespace {

struct Run {
  LaneArray records;  // [samples * records x W]
  std::vector<Outcome> outcome;
};

std::shared_ptr<SimulationProgram const> program_of(SimulationSource source, SolverSettings const& solver) {
  source.integrator = solver.method;
  return std::make_shared<SimulationProgram const>(compile(std::move(source)));
}

Run run(SimulationSource source, SolverSettings const& solver, Experiment const& data, ConstLanes parameters,
        ExecutionOptions options = {}) {
  auto const program = program_of(std::move(source), solver);
  Simulator const simulator(program, Schedule(*program, data, solver), options);
  int const samples = static_cast<int>(data.time.size());
  Run result{LaneArray(samples * program->registers.records, parameters.width()),
             std::vector<Outcome>(static_cast<std::size_t>(parameters.width()))};
  simulator.records(parameters, 0, samples, result.records, result.outcome);
  return result;
}

/// y'' + w^2 y = 0 from y(0) = 1, y'(0) = 0: y = cos(w t); parameter w.
SimulationSource harmonic() {
  SimulationSource source;
  Graph& g = source.graph;
  NodeId const y = g.leaf(LeafKind::state, 0), v = g.leaf(LeafKind::state, 1), w = g.leaf(LeafKind::parameter, 0);
  source.parameters = 1;
  source.initial = {g.constant(1), g.constant(0)};
  source.derivative = {v, g.negate(g.multiply(g.multiply(w, w), y))};
  source.records = {y};
  return source;
}

double harmonic_error(SolverSettings const& solver) {
  Experiment const data = testing::experiment(testing::uniform_times(101, 0.1), {}, {});
  LaneArray w(1, 1);
  w(0, 0) = 1.3;
  Run const result = run(harmonic(), solver, data, w);
  CHECK(result.outcome[0].ok);
  double worst = 0;
  for (int i = 0; i < 101; ++i) worst = std::max(worst, std::abs(result.records(i, 0) - std::cos(1.3 * 0.1 * i)));
  return worst;
}

/// x' = -2 z,  z^2 = x from x(0) = p0, the root beside p1: z = sqrt(p0) - t as long as it is positive. Index 1 but at z = 0.
SimulationSource root() {
  SimulationSource source;
  Graph& g = source.graph;
  NodeId const x = g.leaf(LeafKind::state, 0), z = g.leaf(LeafKind::state, 1);
  source.parameters = 2;
  source.initial = {g.leaf(LeafKind::parameter, 0), g.leaf(LeafKind::parameter, 1)};
  source.derivative = {g.multiply(g.constant(-2), z)};
  source.constraints = {g.subtract(g.multiply(z, z), x)};
  source.records = {x, z};
  return source;
}

LaneArray pair(double a, double b) {
  LaneArray values(2, 1);
  values(0, 0) = a, values(1, 0) = b;
  return values;
}

}  // namespace

TEST_CASE("CVODE, IDA, Dormand-Prince and RK4 agree on a smooth problem with its closed form") {
  // The local error allowed is 1e-10 of 1; over ten radians a BDF of order 5 adds up to some hundred of them.
  CHECK(harmonic_error({.method = "cvode", .relative = 1e-10}) < 1e-7);
  CHECK(harmonic_error({.method = "ida", .relative = 1e-10}) < 1e-7);
  CHECK(harmonic_error({.method = "dopri5", .relative = 1e-10}) < 1e-8);  // some hundred steps of 1e-10 each
  // h w = 0.0065: error of RK4 over N steps is N (h w)^5 / 120 = 2000 * 1.2e-11 / 120.
  CHECK(harmonic_error({.method = "rk4", .substeps = 20}) < 1e-9);
}

TEST_CASE("a tighter tolerance gives a smaller error, in step with it") {
  for (char const* method : {"cvode", "ida"}) {
    CAPTURE(method);
    double const coarse = harmonic_error({.method = method, .relative = 1e-5});
    double const middle = harmonic_error({.method = method, .relative = 1e-7});
    double const fine = harmonic_error({.method = method, .relative = 1e-9});
    CHECK(coarse < 1e-5 * 1000);
    CHECK(middle < coarse / 10);
    CHECK(fine < middle / 10);
  }
}

TEST_CASE("a stiff problem is followed in steps that its solution needs, where RK4 overflows") {
  // y' = -1e6 (y - cos t): the solution is within 1e-6 of cos t.
  SimulationSource source;
  Graph& g = source.graph;
  NodeId const y = g.leaf(LeafKind::state, 0), u = g.leaf(LeafKind::input, 0);
  source.inputs = 1;
  source.initial = {g.constant(0)};
  source.derivative = {g.multiply(g.constant(-1e6), g.subtract(y, u))};
  source.records = {y};
  Experiment const data =
      testing::experiment(testing::uniform_times(101, 0.1), {[](double t) { return std::cos(t); }}, {}, InputRule::cubic);
  SolverSettings const cvode{.method = "cvode", .steps = 3000}, ida{.method = "ida", .steps = 3000}, rk4{.substeps = 100};
  for (SolverSettings const& solver : {cvode, ida}) {
    Run const result = run(source, solver, data, LaneArray(0, 1).view(), {.lanes = 4});
    REQUIRE(result.outcome.size() == 1);
    CHECK(result.outcome[0].ok);
    for (int i = 1; i < 101; ++i) CHECK(std::abs(result.records(i, 0) - std::cos(0.1 * i)) < 2e-5);  // spline of 0.1: 1e-6
  }
  CHECK_FALSE(run(source, rk4, data, LaneArray(0, 1).view()).outcome[0].ok);
}

TEST_CASE("no trajectory depends on the unit of a state") {
  // y'' + 2 y' + (w + u) y = p and the reaction n' = -n^2/p, n(0) = p: with p smaller by a power of two all numbers of a
  // solve are, so that not a bit may change. The oscillator begins at rest, where nothing but its force says how large it will be.
  auto const scaled = [](double size) {
    SimulationSource source;
    Graph& g = source.graph;
    NodeId const y = g.leaf(LeafKind::state, 0), v = g.leaf(LeafKind::state, 1), n = g.leaf(LeafKind::state, 2);
    NodeId const scale = g.constant(size), stiffness = g.add(g.constant(30), g.leaf(LeafKind::input, 0));
    source.inputs = 1;
    source.initial = {g.constant(0), g.constant(0), scale};
    source.derivative = {v, g.subtract(scale, g.add(g.multiply(g.constant(2), v), g.multiply(stiffness, y))),
                         g.negate(g.divide(g.multiply(n, n), scale))};
    source.records = {y, n};
    return source;
  };
  double const small = std::ldexp(1, -70);  // a zeptomole beside a mole
  for (InputRule const rule : {InputRule::zero_order, InputRule::linear, InputRule::cubic}) {
    Experiment const data =
        testing::experiment(testing::uniform_times(21, 0.5), {[](double t) { return 10 * std::sin(t); }}, {}, rule);
    for (char const* method : {"cvode", "ida", "dopri5", "rk4"}) {
      CAPTURE(method);
      Run const large = run(scaled(1), {.method = method}, data, LaneArray(0, 1).view());
      Run const tiny = run(scaled(small), {.method = method}, data, LaneArray(0, 1).view());
      REQUIRE(large.outcome[0].ok);
      REQUIRE(tiny.outcome[0].ok);
      for (int i = 0; i < 42; ++i) CHECK(tiny.records(i, 0) == small * large.records(i, 0));
      if (std::string(method) == "rk4") continue;
      for (int i = 0; i < 21; ++i)  // n = p/(1 + t)
        CHECK(large.records(2 * i + 1, 0) == relative(1 / (1 + 0.5 * i), 1e-6));
    }
  }
}

TEST_CASE("a state whose rate begins at zero, on a kink, has a size") {
  // y' = -1,  z' = |y| from 0: z = t^2/2. Neither the rate of z nor its slope says anything at t = 0.
  SimulationSource source;
  Graph& g = source.graph;
  source.initial = {g.constant(0), g.constant(0)};
  source.derivative = {g.constant(-1), g.unary(Operation::absolute, g.leaf(LeafKind::state, 0))};
  source.records = {g.leaf(LeafKind::state, 1)};
  Experiment const data = testing::experiment(testing::uniform_times(4, 1.0), {}, {});
  for (char const* method : {"cvode", "ida", "dopri5"}) {
    CAPTURE(method);
    Run const result = run(source, {.method = method}, data, LaneArray(0, 1).view());
    REQUIRE(result.outcome[0].ok);
    for (int i = 0; i < 4; ++i) CHECK(result.records(i, 0) == doctest::Approx(0.5 * i * i).epsilon(1e-6));
  }
}

TEST_CASE("a stiff start does not loosen the error control of states that begin at zero") {
  // Robertson's reaction, see below: b stays below 4e-5, where a guess from its first rate would be 1, and 1e9 for c.
  SimulationSource source;
  Graph& g = source.graph;
  NodeId const a = g.leaf(LeafKind::state, 0), b = g.leaf(LeafKind::state, 1), c = g.leaf(LeafKind::state, 2);
  NodeId const first = g.multiply(g.constant(0.04), a), back = g.multiply(g.multiply(g.constant(1e4), b), c);
  NodeId const second = g.multiply(g.constant(3e7), g.multiply(b, b));
  source.initial = {g.constant(1), g.constant(0), g.constant(0)};
  source.derivative = {g.subtract(back, first), g.subtract(g.subtract(first, back), second), second};
  source.records = {a, b, c};
  double const expected[][4] = {{0.4, 0.985172113861, 3.38639537898e-05, 0.0147940221852},
                                {40, 0.715827068719, 9.1855347646e-06, 0.284163745746},
                                {4e5, 0.00493827452098, 1.98499408795e-08, 0.995061705629}};
  for (auto const& row : expected)
    for (char const* method : {"cvode", "ida"}) {
      CAPTURE(method);
      CAPTURE(row[0]);
      Run const result =
          run(source, {.method = method, .relative = 1e-9}, testing::experiment({0, row[0]}, {}, {}), LaneArray(0, 1).view());
      REQUIRE(result.outcome[0].ok);
      for (int r = 0; r < 3; ++r) CHECK(result.records(3 + r, 0) == doctest::Approx(row[r + 1]).scale(0).epsilon(1e-6));
    }
}

TEST_CASE("a state that rounding alone moves asks for no short steps") {
  // A mass hangs at rest on its spring: its acceleration g - k y/m is the rounding error of two forces of 9.81 N, or nothing.
  SimulationSource source;
  Graph& g = source.graph;
  NodeId const y = g.leaf(LeafKind::state, 0), v = g.leaf(LeafKind::state, 1), k = g.leaf(LeafKind::parameter, 0);
  source.parameters = 1;
  source.initial = {g.divide(g.constant(9.81), k), g.constant(0)};
  source.derivative = {v, g.subtract(g.constant(9.81), g.multiply(k, y))};
  source.records = {y};
  Experiment const data = testing::experiment(testing::uniform_times(11, 0.5), {}, {});
  LaneArray stiffness(1, 9);
  for (int w = 0; w < 9; ++w) stiffness(0, w) = 7 * std::pow(10, 0.25 * w);
  for (char const* method : {"cvode", "ida", "dopri5"})
    for (double const tolerance : {1e-6, 1e-10, 1e-13}) {
      CAPTURE(method);
      CAPTURE(tolerance);
      Run const result = run(source, {.method = method, .relative = tolerance, .steps = 1000}, data, stiffness);
      for (int w = 0; w < 9; ++w) {
        REQUIRE(result.outcome[static_cast<std::size_t>(w)].ok);
        CHECK(result.records(10, w) == relative(9.81 / stiffness(0, w), 10 * tolerance));  // one or two steps
      }
    }
}

TEST_CASE("Robertson's reaction over twelve decades of time: published and independently computed values") {
  // Mazzia and Magherini, Test Set for Initial Value Problem Solvers 2.4 (2008), problem ROBER.
  SimulationSource source;
  Graph& g = source.graph;
  NodeId const a = g.leaf(LeafKind::state, 0), b = g.leaf(LeafKind::state, 1), c = g.leaf(LeafKind::state, 2);
  NodeId const first = g.multiply(g.constant(0.04), a), back = g.multiply(g.multiply(g.constant(1e4), b), c);
  NodeId const second = g.multiply(g.constant(3e7), g.multiply(b, b));
  source.initial = {g.constant(1), g.constant(0), g.constant(0)};
  source.derivative = {g.subtract(back, first), g.subtract(g.subtract(first, back), second), second};
  source.records = {a, b, c};
  double const published[] = {0.2083340149701255e-07, 0.8333360770334713e-13, 0.9999999791665050};
  // Radau IIA of order 5, 40 and 80 steps per decade of time, extrapolated: see models/robertson/README.md.
  double const computed[][4] = {{0.4, 0.985172113861, 3.38639537898e-05, 0.0147940221852},
                                {40, 0.715827068719, 9.1855347646e-06, 0.284163745746},
                                {400, 0.450518668471, 3.22290144168e-06, 0.549478108627},
                                {4e5, 0.00493827452098, 1.98499408795e-08, 0.995061705629},
                                {4e11, 5.20835314425e-09, 2.08334126842e-14, 0.999999994792}};
  Experiment const data = testing::experiment({0, 0.4, 40, 400, 4e5, 1e11, 4e11}, {}, {});
  for (char const* method : {"cvode", "ida"}) {
    CAPTURE(method);
    Run const result = run(source, {.method = method, .relative = 1e-10, .absolute = 1e-22}, data, LaneArray(0, 1).view());
    REQUIRE(result.outcome[0].ok);
    for (int r = 0; r < 3; ++r) CHECK(result.records(15 + r, 0) == doctest::Approx(published[r]).scale(0).epsilon(1e-6));
    int sample = 1;
    for (auto const& row : computed) {
      CAPTURE(row[0]);
      for (int r = 0; r < 3; ++r) CHECK(result.records(3 * sample + r, 0) == doctest::Approx(row[r + 1]).scale(0).epsilon(1e-6));
      sample += sample == 4 ? 2 : 1;  // 1e11 s has its own reference
    }
  }
}

TEST_CASE("held and linear inputs are followed from sample to sample, equal to RK4 in fine steps") {
  for (InputRule const rule : {InputRule::zero_order, InputRule::linear, InputRule::cubic}) {
    Experiment const data = testing::experiment(
        testing::uniform_times(60, 0.001), {[](double t) { return 10 * std::sin(300 * t); }}, {[](double) { return 0.0; }}, rule);
    LaneArray parameters(5, 1);
    double const values[] = {1, 20, 1e4, 5e9, 1e8};
    for (int r = 0; r < 5; ++r) parameters(r, 0) = values[r];
    Run const reference = run(systems::duffing(), {.substeps = 50}, data, parameters);
    double largest = 0;
    for (int i = 0; i < 60; ++i) largest = std::max(largest, std::abs(reference.records(2 * i, 0)));
    for (char const* method : {"cvode", "ida"}) {
      CAPTURE(method);
      Run const result = run(systems::duffing(), {.method = method, .relative = 1e-9}, data, parameters);
      for (int i = 0; i < 60; ++i) CHECK(std::abs(result.records(2 * i, 0) - reference.records(2 * i, 0)) < 1e-6 * largest);
    }
  }
}

TEST_CASE("the same bytes for any lanes and threads") {
  int const width = 13, samples = 40;
  Experiment const data =
      testing::experiment(testing::uniform_times(samples, 0.001), {[](double t) { return 10 * std::sin(300 * t); }},
                          {[](double t) { return 1e-4 * std::sin(90 * t); }}, InputRule::zero_order);
  LaneArray parameters(5, width);
  double const centre[] = {1, 20, 1e4, 5e9, 1e8};
  for (int w = 0; w < width; ++w) {
    Stream stream({.seed = 3, .purpose = Purpose::test, .index = static_cast<std::uint64_t>(w), .step = 0});
    for (int r = 0; r < 5; ++r) parameters(r, w) = centre[r] * (1 + 0.1 * stream.normal());
  }
  parameters(3, 4) = -1e15;  // diverges
  for (char const* method : {"cvode", "ida"}) {
    CAPTURE(method);
    SolverSettings const solver{.method = method};
    auto const program = program_of(systems::duffing(), solver);
    LaneArray expected(2, width), found(2, width);
    std::vector<Outcome> outcome(width), again(width);
    Simulator(program, Schedule(*program, data, solver), {.lanes = 4}).sums(parameters, expected, outcome);
    CHECK_FALSE(outcome[4].ok);
    CHECK(outcome[5].ok);
    for (int const lanes : {0, 8, 16})
      for (int const threads : {1, 3}) {
        Simulator(program, Schedule(*program, data, solver), {.lanes = lanes, .threads = threads}).sums(parameters, found, again);
        for (int w = 0; w < width; ++w) {
          CHECK(again[static_cast<std::size_t>(w)].ok == outcome[static_cast<std::size_t>(w)].ok);
          CHECK(again[static_cast<std::size_t>(w)].kind == outcome[static_cast<std::size_t>(w)].kind);
          for (int r = 0; r < 2 && w != 4; ++r)
            CHECK(std::bit_cast<std::uint64_t>(found(r, w)) == std::bit_cast<std::uint64_t>(expected(r, w)));
        }
      }
  }
}

TEST_CASE("algebraic states start consistent, on the branch of their guess, and follow the closed form") {
  Experiment const data = testing::experiment(testing::uniform_times(19, 0.1), {}, {});
  SolverSettings const solver{.method = "ida", .relative = 1e-9};
  Run const result = run(root(), solver, data, pair(4, 30));
  REQUIRE(result.outcome[0].ok);
  for (int i = 0; i < 19; ++i) {
    double const z = 2 - 0.1 * i;
    CHECK(std::abs(result.records(2 * i, 0) - z * z) < 1e-7 * 4);
    CHECK(std::abs(result.records(2 * i + 1, 0) - z) < 1e-7 * 2);
  }
  // The other root: x' = 2 sqrt(x).
  CHECK(run(root(), solver, data, pair(4, -30)).records(2 * 10, 0) == doctest::Approx(9.0).epsilon(1e-6));
}

TEST_CASE("algebraic states read the input of their own row, the last one included, under every rule") {
  // y' = z,  2 z = u:  z_i = u_i / 2 at every sample, and y follows as it does without the algebraic state.
  SimulationSource implicit, explicit_one;
  {
    Graph& g = implicit.graph;
    NodeId const z = g.leaf(LeafKind::state, 1);
    implicit.inputs = 1;
    implicit.initial = {g.constant(0), g.constant(0)};
    implicit.derivative = {z};
    implicit.constraints = {g.subtract(g.multiply(g.constant(2), z), g.leaf(LeafKind::input, 0))};
    implicit.records = {g.leaf(LeafKind::state, 0), z};
  }
  {
    Graph& g = explicit_one.graph;
    NodeId const z = g.multiply(g.constant(0.5), g.leaf(LeafKind::input, 0));
    explicit_one.inputs = 1;
    explicit_one.initial = {g.constant(0)};
    explicit_one.derivative = {z};
    explicit_one.records = {g.leaf(LeafKind::state, 0), z};
  }
  int const samples = 12;
  for (InputRule const rule : {InputRule::zero_order, InputRule::linear, InputRule::cubic, InputRule::band_limited}) {
    CAPTURE(static_cast<int>(rule));
    Experiment const data =
        testing::experiment(testing::uniform_times(samples, 0.5), {[](double t) { return 1 + std::sin(2.5 * t); }}, {}, rule);
    Run const ida = run(implicit, {.method = "ida", .relative = 1e-10}, data, LaneArray(0, 1).view());
    Run const rk4 = run(explicit_one, {.substeps = 200}, data, LaneArray(0, 1).view());
    REQUIRE(ida.outcome[0].ok);
    for (int i = 0; i < samples; ++i) {
      CAPTURE(i);
      CHECK(ida.records(2 * i, 0) == relative(rk4.records(2 * i, 0), 1e-7));
      CHECK(ida.records(2 * i + 1, 0) == relative(rk4.records(2 * i + 1, 0), 1e-9));
    }
  }
}

TEST_CASE("a constraint that nothing satisfies is named") {
  Experiment const data = testing::experiment(testing::uniform_times(5, 0.1), {}, {[](double) { return 0.0; }});
  SimulationSource source = root();
  source.channels = {{{source.records[0]}}};
  source.integrator = "ida";
  auto const program = std::make_shared<SimulationProgram const>(compile(source));
  SolverSettings const solver{.method = "ida"};
  Simulator const simulator(program, Schedule(*program, data, solver));
  LaneArray const impossible = pair(-1, 1);  // z^2 = -1
  LaneArray out(1, 1);
  Outcome outcome;
  simulator.sums(impossible, out, {&outcome, 1});
  CHECK_FALSE(outcome.ok);
  CHECK(outcome.kind == FailureClass::inconsistent);
  double const values[] = {-1, 1};
  auto const found = simulator.diagnose(values);
  REQUIRE(found);
  CHECK(found->kind == FailureClass::inconsistent);
  CHECK(found->node == program->source.constraints[0]);
  CHECK(found->time == 0);
}

TEST_CASE("a solve that reaches a singular point fails there, as an outcome") {
  Experiment const data = testing::experiment(testing::uniform_times(31, 0.1), {}, {});
  Run const result = run(root(), {.method = "ida"}, data, pair(4, 1));  // z = 0 at t = 2
  CHECK_FALSE(result.outcome[0].ok);
  CHECK(std::isnan(result.records(0, 0)));
}

namespace {

std::atomic<int> looks = 0;
bool soon() { return ++looks > 20; }

}  // namespace

TEST_CASE("every solver can be left within one interval between samples") {
  // Some 10^11 steps of any solver, were it not left.
  Experiment const data = testing::experiment({0, 1e12, 2e12}, {}, {});
  LaneArray w(1, 5);
  for (int lane = 0; lane < 5; ++lane) w(0, lane) = 1 + lane;
  for (char const* method : {"cvode", "ida", "dopri5"}) {
    for (ExecutorKind const executor : {ExecutorKind::lanes, ExecutorKind::native}) {
      CAPTURE(method);
      looks = 0;
      ExecutionOptions options{.threads = 1, .executor = executor, .stopped = &soon};
      Run const left = run(harmonic(), {.method = method, .relative = 1e-8, .steps = 1'000'000'000}, data, w, options);
      CHECK(looks > 20);
      for (Outcome const& outcome : left.outcome) CHECK_FALSE(outcome.ok);
      looks = 0;
      options.throws = true;
      CHECK_THROWS_AS(run(harmonic(), {.method = method, .relative = 1e-8, .steps = 1'000'000'000}, data, w, options), Interrupted);
    }
  }
}

TEST_CASE("a budget that is spent, and an expression that is not finite, have their classes") {
  Experiment const data = testing::experiment(testing::uniform_times(31, 0.1), {}, {[](double) { return 0.0; }});
  SimulationSource fast = harmonic();
  fast.channels = {{{fast.records[0]}}};
  fast.integrator = "cvode";
  auto const program = std::make_shared<SimulationProgram const>(compile(fast));
  SolverSettings const poor{.method = "cvode", .steps = 5};
  Simulator const simulator(program, Schedule(*program, data, poor));
  double const frequency = 1000;
  auto const found = simulator.diagnose({&frequency, 1});
  REQUIRE(found);
  CHECK(found->kind == FailureClass::step_limit);
  CHECK(found->sample == 1);

  SimulationSource ending;
  Graph& g = ending.graph;
  NodeId const y = g.leaf(LeafKind::state, 0);
  ending.initial = {g.constant(1)};
  NodeId const root_of = g.unary(Operation::square_root, g.subtract(y, g.constant(0.5)));
  ending.derivative = {g.negate(g.add(g.constant(1), root_of))};  // y passes 1/2 at speed 1: the root has no value beyond
  ending.channels = {{{y}}};
  for (char const* method : {"cvode", "ida"}) {
    ending.integrator = method;
    auto const other = std::make_shared<SimulationProgram const>(compile(ending));
    SolverSettings const solver{.method = method};
    auto const broken = Simulator(other, Schedule(*other, data, solver)).diagnose({});
    REQUIRE(broken);
    CHECK(broken->kind == FailureClass::non_finite);
    CHECK(other->source.graph[broken->node].operation == Operation::square_root);
    // s = sqrt(y - 1/2): 2 s s' = -(1 + s), so t = 2 (s0 - log(1 + s0)) at s = 0.
    CHECK(broken->time == doctest::Approx(2 * (std::sqrt(0.5) - std::log(1 + std::sqrt(0.5)))).epsilon(1e-3));
  }
}
