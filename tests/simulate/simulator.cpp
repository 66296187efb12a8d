// Sums and records against plain loops; independence of lanes, widths, threads and instruction sets; missing samples; failed lanes.
#include "simulate/simulator.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "core/numeric/instruction_set.hpp"
#include "core/numeric/random.hpp"
#include "core/text/diagnostic.hpp"
#include "program/interpreter/executor.hpp"
#include "relative.hpp"
#include "simulate/experiments.hpp"
#include "simulate/systems.hpp"

using namespace sysid;

namespace {

double const missing = std::numeric_limits<double>::quiet_NaN();

bool same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || (a != a && b != b); }

Experiment record(int samples) {
  return testing::experiment(testing::uniform_times(samples, 0.001),
                             {[](double t) { return 10 * std::sin(300 * t) + 5 * std::cos(77 * t); }},
                             {[](double t) { return 1e-4 * std::sin(90 * t); }});
}

LaneArray duffing_parameters(int width, std::uint64_t seed = 1) {
  double const centre[] = {1, 20, 1e4, 5e9, 1e8};
  LaneArray parameters(5, width);
  for (int w = 0; w < width; ++w) {
    Stream stream({.seed = seed, .purpose = Purpose::test, .index = static_cast<std::uint64_t>(w), .step = 0});
    for (int r = 0; r < 5; ++r) parameters(r, w) = centre[r] * (1 + 0.1 * stream.normal());
  }
  return parameters;
}

struct Sums {
  LaneArray values;
  std::vector<Outcome> outcome;
};

Sums sums(Simulator const& simulator, ConstLanes parameters) {
  Sums result{LaneArray(simulator.program().sum_count(), parameters.width()),
              std::vector<Outcome>(static_cast<std::size_t>(parameters.width()))};
  simulator.sums(parameters, result.values, result.outcome);
  return result;
}

/// Textbook RK4 of Duffing's equation, as written; returns y at every sample.
std::vector<double> plain_duffing(Experiment const& record, double m, double c, double k, double k3) {
  std::vector<double> trajectory{0};
  double y = 0, v = 0;
  for (int i = 0; i + 1 < static_cast<int>(record.time.size()); ++i) {
    double const h = record.time[static_cast<std::size_t>(i) + 1] - record.time[static_cast<std::size_t>(i)];
    auto const a = [&](double s, double at_y, double at_v) {
      return (record.inputs[0].value(i, s) - c * at_v - k * at_y - k3 * at_y * at_y * at_y) / m;
    };
    double const a1 = a(0, y, v), v2 = v + h / 2 * a1, a2 = a(0.5, y + h / 2 * v, v2), v3 = v + h / 2 * a2;
    double const a3 = a(0.5, y + h / 2 * v2, v3), v4 = v + h * a3, a4 = a(1, y + h * v3, v4);
    y += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    trajectory.push_back(y);
  }
  return trajectory;
}

}  // namespace

TEST_CASE("more steps than can be counted are refused before their tables are made") {
  SimulationProgram const program = compile(systems::duffing());
  CHECK_THROWS_AS(Schedule(program, record(220000), {.substeps = 10000}), UserError);
}

TEST_CASE("trajectories equal a plain RK4 loop to rounding, sums a plain sum over them") {
  int const samples = 200, width = 5;
  Experiment const data = record(samples);
  auto const program = std::make_shared<SimulationProgram const>(compile(systems::duffing()));
  Simulator const simulator(program, Schedule(*program, data, {.substeps = 1}));
  LaneArray const parameters = duffing_parameters(width);
  LaneArray out(2 * samples, width);
  std::vector<Outcome> outcome(width);
  simulator.records(parameters, 0, samples, out, outcome);
  Sums const totals = sums(simulator, parameters);
  for (int w = 0; w < width; ++w) {
    std::vector<double> const plain = plain_duffing(data, parameters(0, w), parameters(1, w), parameters(2, w), parameters(3, w));
    double squares = 0, worst = 0, largest = 0;
    for (int i = 0; i < samples; ++i) {
      double const y = plain[static_cast<std::size_t>(i)];
      worst = std::max(worst, std::abs(out(2 * i, w) - y));
      largest = std::max(largest, std::abs(y));
      double const r = data.measured[0][static_cast<std::size_t>(i)] - y;
      squares += r * r;
    }
    CHECK(worst < 1e-12 * largest);
    double const precision = parameters(4, w);
    double const expected = samples * 0.5 * std::log(precision / (2 * M_PI)) - 0.5 * precision * squares;
    CHECK(totals.outcome[static_cast<std::size_t>(w)].ok);
    CHECK(totals.values(0, w) == doctest::Approx(expected).epsilon(1e-12));
    CHECK(totals.values(1, w) == relative(squares, 1e-12));
  }
}

TEST_CASE("the result of a lane depends on neither width, position, threads nor instruction set") {
  Experiment const data = record(150);
  for (SimulationSource (*make)() : {+[] { return systems::duffing(); }, +[] { return systems::bouc_wen(0); }}) {
    auto const program = std::make_shared<SimulationProgram const>(compile(make()));
    int const width = 141;
    LaneArray parameters = duffing_parameters(width);
    if (program->source.parameters == 6) {
      LaneArray with_exponent(6, width);
      for (int w = 0; w < width; ++w) {
        double const values[] = {2, 10, 5e4, 0.8, -1.1, 1.5};
        for (int r = 0; r < 6; ++r) with_exponent(r, w) = values[r] * (1 + 0.001 * w);
      }
      parameters = with_exponent;
    }
    parameters(0, 17) = missing;  // one lane fails in every setting
    InstructionSet const before = instruction_set();
    Sums const expected = sums(Simulator(program, Schedule(*program, data, {.substeps = 2})), parameters);
    CHECK_FALSE(expected.outcome[17].ok);
    for (InstructionSet const set : {narrowest_instruction_set, InstructionSet::avx512}) {
      if (set > *supported_instruction_set()) continue;
      force_instruction_set(set);
      for (int const lanes : {4, 8, 16, 32, 64}) {
        for (int const threads : {1, 3}) {
          Simulator const simulator(program, Schedule(*program, data, {.substeps = 2}), {.lanes = lanes, .threads = threads});
          for (int const first : {0, 3, 17}) {
            Sums const other = sums(simulator, parameters.view().columns(first, width - first));
            bool equal = true;
            for (int w = 0; w + first < width; ++w) {
              Outcome const a = other.outcome[static_cast<std::size_t>(w)],
                            b = expected.outcome[static_cast<std::size_t>(w + first)];
              equal = equal && a.ok == b.ok && a.sample == b.sample;
              for (int r = 0; r < program->sum_count(); ++r)
                equal = equal && same(other.values(r, w), expected.values(r, w + first));
            }
            CAPTURE(std::string(name(set)));
            CAPTURE(lanes);
            CAPTURE(threads);
            CAPTURE(first);
            CHECK(equal);
          }
        }
      }
    }
    force_instruction_set(before);
  }
}

TEST_CASE("the scalar oracle gives the same bytes") {
  Experiment const data = record(100);
  auto const program = std::make_shared<SimulationProgram const>(compile(systems::duffing()));
  Schedule const schedule(*program, data, {.substeps = 1});
  LaneArray const parameters = duffing_parameters(3);
  Sums const expected = sums(Simulator(program, schedule), parameters);
  for (int w = 0; w < 3; ++w) {
    std::vector<double> registers(static_cast<std::size_t>(program->registers.total()));
    std::vector<double> uniforms = program->constants;
    uniforms.resize(static_cast<std::size_t>(program->uniforms));
    auto const run = [&](Section const& section, double const* row, int size) {
      std::copy(row, row + size, uniforms.begin() + static_cast<std::ptrdiff_t>(program->constants.size()));
      sysid::run_scalar(section.code, uniforms.data(), registers.data());
    };
    for (int r = 0; r < 5; ++r) registers[static_cast<std::size_t>(r)] = parameters(r, w);
    run(program->prologue, nullptr, 0);
    run(program->start, nullptr, 0);
    for (int i = 0; i < 100; ++i) {
      run(program->observe[0], schedule.observe_row(0, i), program->observe[0].uniforms.kernel.outputs);
      if (i + 1 < 100) run(program->step, schedule.step_row(i, 0), program->step.uniforms.kernel.outputs);
    }
    run(program->epilogue, schedule.epilogue_row().data(), static_cast<int>(schedule.epilogue_row().size()));
    for (int r = 0; r < 2; ++r)
      CHECK(same(registers[static_cast<std::size_t>(program->registers.first_sum() + r)], expected.values(r, w)));
  }
}

TEST_CASE("missing and unscored samples are simulated but not summed") {
  int const samples = 120;
  Experiment data = record(samples);
  auto const program = std::make_shared<SimulationProgram const>(compile(systems::duffing()));
  Sums const all = sums(Simulator(program, Schedule(*program, data, {.substeps = 1})), duffing_parameters(2));
  data.measured[0][7] = missing;
  data.measured[0][50] = missing;
  for (int i = 0; i < 30; ++i) data.scored[static_cast<std::size_t>(i)] = 0;
  data.scored[119] = 0;
  Schedule const schedule(*program, data, {.substeps = 1});
  CHECK(schedule.count(0) == 120 - 30 - 1 - 1);
  CHECK(schedule.last_summed() == 119);
  CHECK_FALSE(schedule.summed(0, 50));
  Simulator const simulator(program, schedule);
  LaneArray const parameters = duffing_parameters(2);
  Sums const some = sums(simulator, parameters);
  LaneArray out(2 * samples, 2);
  std::vector<Outcome> outcome(2);
  simulator.records(parameters, 0, samples, out, outcome);
  for (int w = 0; w < 2; ++w) {
    double squares = 0;
    for (int i = 30; i < 119; ++i) {
      if (i == 50) continue;
      double const r = data.measured[0][static_cast<std::size_t>(i)] - out(2 * i, w);
      squares += r * r;
    }
    CHECK(some.values(1, w) == relative(squares, 1e-13));
    double const expected = 88 * 0.5 * std::log(parameters(4, w) / (2 * M_PI)) - 0.5 * parameters(4, w) * squares;
    CHECK(some.values(0, w) == doctest::Approx(expected).epsilon(1e-12));
    CHECK(some.values(1, w) < all.values(1, w));
  }
}

TEST_CASE("a channel that is not in the data adds nothing") {
  Experiment data = record(50);
  data.measured[0].clear();
  auto const program = std::make_shared<SimulationProgram const>(compile(systems::duffing()));
  Sums const none = sums(Simulator(program, Schedule(*program, data, {.substeps = 1})), duffing_parameters(3));
  for (int w = 0; w < 3; ++w) {
    CHECK(none.outcome[static_cast<std::size_t>(w)].ok);
    CHECK(none.values(0, w) == 0);
    CHECK(none.values(1, w) == 0);
  }
}

TEST_CASE("failed lanes are reported, are NaN, and leave their neighbours alone") {
  Experiment const data = record(300);
  auto const program = std::make_shared<SimulationProgram const>(compile(systems::duffing()));
  Simulator const simulator(program, Schedule(*program, data, {.substeps = 1}));
  int const width = 20;
  LaneArray parameters = duffing_parameters(width);
  Sums const healthy = sums(simulator, parameters);
  parameters(1, 4) = -1e6;    // anti-damped: grows until it overflows
  parameters(3, 11) = -1e18;  // softens without bound
  parameters(0, 19) = 0;      // 1/m is infinite
  Sums const mixed = sums(simulator, parameters);
  LaneArray out(2 * 300, width);
  std::vector<Outcome> outcome(width);
  simulator.records(parameters, 0, 300, out, outcome);
  for (int w = 0; w < width; ++w) {
    bool const dead = w == 4 || w == 11 || w == 19;
    CHECK(mixed.outcome[static_cast<std::size_t>(w)].ok == !dead);
    CHECK(outcome[static_cast<std::size_t>(w)].ok == !dead);
    CHECK(std::isnan(out(0, w)) == dead);
    for (int r = 0; r < 2; ++r) CHECK(same(mixed.values(r, w), dead ? missing : healthy.values(r, w)));
    if (dead) CHECK(mixed.outcome[static_cast<std::size_t>(w)].sample >= 0);
  }
}

TEST_CASE("a batch of failed lanes ends early and in order") {
  Experiment const data = record(300);
  auto const program = std::make_shared<SimulationProgram const>(compile(systems::duffing()));
  Simulator const simulator(program, Schedule(*program, data, {.substeps = 1}));
  LaneArray parameters = duffing_parameters(6);
  for (int w = 0; w < 6; ++w) parameters(0, w) = 0;
  Sums const dead = sums(simulator, parameters);
  for (Outcome const& outcome : dead.outcome) {
    CHECK_FALSE(outcome.ok);
    CHECK(outcome.sample < 64);
  }
}

TEST_CASE("records of part of the samples are those rows of all records") {
  Experiment const data = record(90);
  auto const program = std::make_shared<SimulationProgram const>(compile(systems::duffing()));
  Simulator const simulator(program, Schedule(*program, data, {.substeps = 3}));
  LaneArray const parameters = duffing_parameters(2);
  LaneArray all(2 * 90, 2), part(2 * 20, 2);
  std::vector<Outcome> outcome(2);
  simulator.records(parameters, 0, 90, all, outcome);
  simulator.records(parameters, 40, 60, part, outcome);
  for (int w = 0; w < 2; ++w)
    for (int r = 0; r < 40; ++r) CHECK(part(r, w) == all(80 + r, w));
}

TEST_CASE("redrawing the same parameters changes nothing, other parameters act from their sample on") {
  Experiment const data = record(80);
  auto const program = std::make_shared<SimulationProgram const>(compile(systems::duffing()));
  Simulator const simulator(program, Schedule(*program, data, {.substeps = 1}), {.lanes = 8, .threads = 2});
  int const width = 20;
  LaneArray const parameters = duffing_parameters(width), others = duffing_parameters(width, 2);
  auto const copy = [](ConstLanes from, int lane, Lanes to) {
    for (int r = 0; r < to.rows(); ++r)
      for (int w = 0; w < to.width(); ++w) to(r, w) = from(r, lane + w);
  };
  LaneArray plain(2 * 80, width), redrawn(2 * 80, width), changed(2 * 80, width);
  std::vector<Outcome> outcome(width);
  simulator.records(parameters, 0, 80, plain, outcome);
  simulator.records_redrawn([&](int, int lane, Lanes to) { copy(parameters, lane, to); }, 0, 80, redrawn, outcome);
  simulator.records_redrawn([&](int sample, int lane, Lanes to) { copy(sample < 30 ? parameters : others, lane, to); }, 0, 80,
                            changed, outcome);
  for (int w = 0; w < width; ++w) {
    for (int r = 0; r < 2 * 80; ++r) CHECK(same(plain(r, w), redrawn(r, w)));
    for (int i = 0; i <= 30; ++i) CHECK(same(plain(2 * i, w), changed(2 * i, w)));
    CHECK_FALSE(plain(2 * 31, w) == changed(2 * 31, w));
  }
}

namespace {

int asked = 0;
bool after_a_while() { return ++asked > 100; }

}  // namespace

TEST_CASE("what is told to stop on the way has no result, and ends there") {
  auto const program = std::make_shared<SimulationProgram const>(compile(systems::duffing()));
  LaneArray const parameters = duffing_parameters(3);
  Experiment const data = record(1000);
  asked = 0;
  Simulator const simulator(program, Schedule(*program, data, {}), {.lanes = 0, .threads = 1, .stopped = &after_a_while});
  Sums const given_up = sums(simulator, parameters);
  CHECK(asked == 101);
  for (int w = 0; w < 3; ++w) {
    CHECK(!given_up.outcome[static_cast<std::size_t>(w)].ok);
    CHECK(given_up.outcome[static_cast<std::size_t>(w)].sample == 100);
    CHECK(std::isnan(given_up.values(0, w)));
  }
  std::vector<double> const one = {1, 20, 1e4, 5e9, 1e8};
  CHECK(!simulator.diagnose(one));
}
