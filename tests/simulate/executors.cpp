// Whole simulations on every executor: the oracle, lanes and machine code give the same bytes, failed lanes and gaps included.
#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "core/numeric/instruction_set.hpp"
#include "core/numeric/random.hpp"
#include "native/module.hpp"
#include "replications.hpp"
#include "simulate/experiments.hpp"
#include "simulate/simulator.hpp"
#include "simulate/systems.hpp"
#include "simulate/wavefront.hpp"

using namespace sysid;

namespace {

struct Setting {
  std::string name;
  SimulationSource source;
  SolverSettings solver;
  std::vector<double> centre;
  bool unequal = false;  // steps of the record
};

/// A memory of the last sample, a sign, a choice and two channels that share a state.
SimulationSource switching() {
  SimulationSource source;
  Graph& g = source.graph;
  NodeId const y = g.leaf(LeafKind::state, 0), v = g.leaf(LeafKind::state, 1), last = g.leaf(LeafKind::state, 2);
  NodeId const k = g.leaf(LeafKind::parameter, 0), friction = g.leaf(LeafKind::parameter, 1), x = g.leaf(LeafKind::input, 0);
  source.parameters = 2;
  source.inputs = 1;
  source.initial = {g.constant(0.01), g.constant(0), g.constant(0)};
  NodeId const stiffer = g.select(g.binary(Operation::less, last, y), g.multiply(g.constant(1.5), k), k);
  NodeId const force = g.subtract(x, g.multiply(friction, g.unary(Operation::sign, v)));
  source.derivative = {v, g.subtract(force, g.multiply(stiffer, y)), g.constant(0)};
  source.memories = {y};
  auto const squares = [&](int channel, NodeId of) {
    return g.power(g.subtract(g.leaf(LeafKind::measured, channel), of), g.constant(2));
  };
  source.channels = {{{squares(0, y)}}, {{squares(1, g.multiply(y, last)), g.unary(Operation::absolute, squares(1, v))}}};
  source.records = {y, g.multiply(v, last), g.leaf(LeafKind::measured, 0)};
  return source;
}

/// A linear oscillator whose noise reads the sample before.
SimulationSource remembering() {
  SimulationSource source = switching();
  Graph& g = source.graph;
  NodeId const y = g.leaf(LeafKind::state, 0), v = g.leaf(LeafKind::state, 1), x = g.leaf(LeafKind::input, 0);
  NodeId const k = g.leaf(LeafKind::parameter, 0), c = g.leaf(LeafKind::parameter, 1);
  source.derivative = {v, g.subtract(g.subtract(x, g.multiply(c, v)), g.multiply(k, y)), g.constant(0)};
  source.integrator = "exponential";
  return source;
}

SimulationSource with(SimulationSource source, std::string const& integrator) {
  source.integrator = integrator;
  return source;
}

std::vector<Setting> settings() {
  std::vector<double> const duffing = {1, 20, 1e4, 5e9, 1e8};
  return {{"duffing", systems::duffing(), {.substeps = 1}, duffing},
          {"duffing, substeps", systems::duffing(), {.substeps = 3}, duffing},
          {"duffing, heun", with(systems::duffing(), "heun"), {.method = "heun", .substeps = 2}, duffing},
          {"duffing, adaptive", with(systems::duffing(), "dopri5"), {.method = "dopri5", .relative = 1e-5}, duffing},
          {"bouc_wen", systems::bouc_wen(2), {.substeps = 1}, {2, 10, 5e4, 0.8, -1.1}},
          {"bouc_wen with a power", systems::bouc_wen(0), {.substeps = 1}, {2, 10, 5e4, 0.8, -1.1, 1.5}},
          {"linear", systems::linear_chain(2), {.method = "exponential"}, {1, 2, 400, 410, 1e8}},
          {"linear, unequal steps", systems::linear_chain(2), {.method = "exponential"}, {1, 2, 400, 410, 1e8}, true},
          {"linear, remembering, unequal steps", remembering(), {.method = "exponential"}, {3e3, 0.5}, true},
          {"linear, remembering", remembering(), {.method = "exponential"}, {3e3, 0.5}},
          {"switching", switching(), {.substeps = 1}, {3e3, 0.5}},
          {"switching, substeps", switching(), {.substeps = 2}, {3e3, 0.5}}};
}

Experiment record_with_gaps(bool unequal = false) {
  auto const input = [](double t) { return 10 * std::sin(300 * t) + 5 * std::cos(77 * t); };
  auto const channel = [](double t) { return 1e-4 * std::sin(90 * t); };
  Experiment record = testing::experiment(unequal ? testing::unequal_times(150, 0.001) : testing::uniform_times(150, 0.001),
                                          {input}, {channel, channel});
  for (int const i : {0, 7, 63, 64, 149}) record.measured[0][static_cast<std::size_t>(i)] = std::nan("");
  for (std::size_t i = 20; i < 30; ++i) record.scored[i] = 0;
  return record;
}

LaneArray around(std::vector<double> const& centre, int width) {
  LaneArray parameters(static_cast<int>(centre.size()), width);
  for (int w = 0; w < width; ++w) {
    Stream stream({.seed = 9, .purpose = Purpose::test, .index = static_cast<std::uint64_t>(w), .step = 0});
    for (int r = 0; r < parameters.rows(); ++r)
      parameters(r, w) = centre[static_cast<std::size_t>(r)] * (1 + 0.1 * stream.normal());
  }
  if (width > 17) parameters(0, 17) = std::nan("");
  if (width > 20) parameters(0, 20) = -1e12;
  return parameters;
}

/// All that a simulator computes, NaNs as one value.
std::vector<std::uint64_t> everything(Simulator const& simulator, ConstLanes parameters) {
  std::vector<std::uint64_t> bits;
  auto const add = [&](double value) { bits.push_back(value != value ? ~0ull : std::bit_cast<std::uint64_t>(value)); };
  auto const add_all = [&](LaneArray const& values, std::vector<Outcome> const& outcome) {
    for (int w = 0; w < values.width(); ++w) {
      for (int r = 0; r < values.rows(); ++r) add(values(r, w));
      Outcome const& of = outcome[static_cast<std::size_t>(w)];
      add(of.ok ? -2 : of.sample);
    }
  };
  int const width = parameters.width(), records = simulator.program().registers.records;
  auto const lanes = static_cast<std::size_t>(width);
  std::vector<Outcome> outcome(lanes);
  LaneArray sums(simulator.program().sum_count(), width);
  simulator.sums(parameters, sums, outcome);
  add_all(sums, outcome);
  for (auto const& [first, last] : {std::pair(0, 150), std::pair(70, 131)}) {
    LaneArray out((last - first) * records, width);
    simulator.records(parameters, first, last, out, outcome);
    add_all(out, outcome);
  }
  LaneArray redrawn(150 * records, width);
  simulator.records_redrawn(
      [&](int sample, int lane, Lanes into) {
        for (int r = 0; r < into.rows(); ++r)
          for (int w = 0; w < into.width(); ++w) into(r, w) = parameters(r, lane + w) * (1 + 1e-4 * sample);
      },
      0, 150, redrawn, outcome);
  add_all(redrawn, outcome);
  std::vector<Ending> endings(lanes);
  std::vector<int> failed_at(lanes);
  Work const work = wavefront_work(
      simulator, parameters, [](ConstLanes partial, int column, int) { return partial(0, column) < 3e-7; }, sums, endings,
      failed_at);
  do_work({&work, 1}, nullptr);
  for (std::size_t w = 0; w < lanes; ++w) {
    add(static_cast<double>(endings[w]));
    add(failed_at[w]);
    for (int r = 0; r < sums.rows(); ++r) add(sums(r, static_cast<int>(w)));
  }
  return bits;
}

}  // namespace

TEST_CASE("every executor gives the bytes of the oracle, for any width, position and number of threads") {
  REQUIRE((native::module() != nullptr || narrowest_instruction_set == InstructionSet::neon));  // which has no such compiler
  InstructionSet const before = instruction_set();
  std::vector<ExecutionOptions> ways;
  for (int const lanes : {0, 1, 4, 8, 16, 32}) ways.push_back({.lanes = lanes, .executor = ExecutorKind::native});
  ways.push_back({.threads = 3, .executor = ExecutorKind::native});
  std::size_t number = 0;  // of the setting
  for (Setting const& setting : settings()) {
    ++number;
    CAPTURE(setting.name);
    Experiment const record = record_with_gaps(setting.unequal);
    auto const program = std::make_shared<SimulationProgram const>(compile(setting.source));
    LaneArray const parameters = around(setting.centre, 45);
    auto const simulator = [&](ExecutionOptions const& options) {
      return Simulator(program, Schedule(*program, record, setting.solver), options);
    };
    std::vector<std::uint64_t> const expected = everything(simulator({.executor = ExecutorKind::scalar}), parameters);
    for (InstructionSet const set : {narrowest_instruction_set, InstructionSet::avx512}) {
      if (set > *supported_instruction_set()) continue;
      force_instruction_set(set);
      CAPTURE(std::string(name(set)));
      CHECK(everything(simulator({.executor = ExecutorKind::lanes}), parameters) == expected);
      for (std::size_t way = 0; way < ways.size(); ++way) {
        // Each way with each instruction set for every third setting: a way that goes astray does so for many programs.
        if (!full_size() && (way + number + (set == narrowest_instruction_set ? 0 : 1)) % 3 != 0) continue;
        CAPTURE(way);
        CHECK(everything(simulator(ways[way]), parameters) == expected);
      }
    }
    force_instruction_set(before);
  }
}

TEST_CASE("machine code is made when a program has been interpreted for long enough, and not before") {
  Experiment const record = record_with_gaps();
  auto const program = std::make_shared<SimulationProgram const>(compile(systems::duffing()));
  Simulator const simulator(program, Schedule(*program, record, {.substeps = 1}));
  double const work = 1e6;  // lane-instructions: some 0.1 ms
  CHECK(simulator.executor(32, work, native::LoopKind::observe).kind == ExecutorKind::lanes);
  int batches = 1;
  while (batches < 100000 && simulator.executor(32, work, native::LoopKind::observe).kind == ExecutorKind::lanes) ++batches;
  if (narrowest_instruction_set == InstructionSet::neon && native::module() == nullptr) {
    CHECK(batches == 100000);  // without a compiler, never
    return;
  }
  CHECK(batches > 100);
  CHECK(batches < 10000);
  // Loops of records have been interpreted for no time yet.
  CHECK(simulator.executor(32, work, native::LoopKind::record).kind == ExecutorKind::lanes);
  Simulator const lanes(program, Schedule(*program, record, {.substeps = 1}), {.executor = ExecutorKind::lanes});
  CHECK(lanes.executor(32, work, native::LoopKind::observe).kind == ExecutorKind::lanes);
}
