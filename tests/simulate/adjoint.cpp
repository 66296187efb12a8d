// The gradient of programs by their adjoint: against tangents, against a closed form, and the same bytes however it is computed.
#include "program/adjoint.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <vector>

#include "core/numeric/instruction_set.hpp"
#include "native/module.hpp"
#include "program/tangents.hpp"
#include "relative.hpp"
#include "replications.hpp"
#include "simulate/experiments.hpp"
#include "simulate/random_sources.hpp"
#include "simulate/simulator.hpp"
#include "simulate/systems.hpp"

using namespace sysid;

namespace adjoint_tests {
namespace {

struct Gradients {
  LaneArray sums, slopes;
  std::vector<Outcome> outcome;
};

Gradients gradients(SimulationSource source, std::vector<int> const& by, Experiment const& experiment, SolverSettings const& solver,
                    LaneArray const& parameters, ExecutionOptions const& options = {}) {
  source.adjoint_by = by;
  auto const program = std::make_shared<SimulationProgram const>(compile(std::move(source)));
  Simulator const simulator(program, Schedule(*program, experiment, solver), options);
  int const width = parameters.width();
  Gradients found{LaneArray(program->sum_count(), width), LaneArray(static_cast<int>(by.size()), width),
                  std::vector<Outcome>(static_cast<std::size_t>(width))};
  Work const work = simulator.gradients_work(parameters, found.sums, found.slopes, found.outcome);
  auto const pool = make_pool(options);
  do_work({&work, 1}, pool.get());
  return found;
}

/// The sums and their derivatives as `with_gradient` has them.
LaneArray tangents(SimulationSource const& source, std::vector<int> const& by, Experiment const& experiment,
                   SolverSettings const& solver, LaneArray const& parameters) {
  auto const program = std::make_shared<SimulationProgram const>(compile(with_gradient(source, by)));
  Simulator const simulator(program, Schedule(*program, experiment, solver));
  LaneArray sums(program->sum_count(), parameters.width());
  std::vector<Outcome> outcome(static_cast<std::size_t>(parameters.width()));
  simulator.sums(parameters, sums, outcome);
  return sums;
}

LaneArray column(std::vector<double> const& values) {
  LaneArray result(static_cast<int>(values.size()), 1);
  for (std::size_t p = 0; p < values.size(); ++p) result(static_cast<int>(p), 0) = values[p];
  return result;
}

bool same_bytes(LaneArray const& a, LaneArray const& b) {
  bool equal = a.rows() == b.rows() && a.width() == b.width();
  for (int r = 0; r < a.rows() && equal; ++r)
    for (int w = 0; w < a.width(); ++w) {
      bool const both_nan = std::isnan(a(r, w)) && std::isnan(b(r, w));
      equal = equal && (both_nan || std::bit_cast<std::uint64_t>(a(r, w)) == std::bit_cast<std::uint64_t>(b(r, w)));
    }
  return equal;
}

struct Case {
  std::string name;
  SimulationSource source;
  SolverSettings solver;
  std::vector<double> centre;
  std::vector<int> by;
  bool unequal = false;  // steps of the record
};

SimulationSource with_second_channel(SimulationSource source) {
  Graph& g = source.graph;
  source.channels.push_back({{systems::normal_log_density(g, 1, g.leaf(LeafKind::state, 1), g.leaf(LeafKind::parameter, 4)),
                              g.multiply(g.leaf(LeafKind::parameter, 0), g.leaf(LeafKind::state, 0))}});
  return source;
}

/// y_(n+1) = a y_n + b x_n - c y_n^3
SimulationSource map() {
  SimulationSource source;
  Graph& g = source.graph;
  auto const p = [&](int i) { return g.leaf(LeafKind::parameter, i); };
  NodeId const y = g.leaf(LeafKind::state, 0), x = g.leaf(LeafKind::input, 0);
  source.parameters = 4;
  source.inputs = 1;
  source.map = true;
  source.initial = {p(3)};
  source.derivative = {g.subtract(g.add(g.multiply(p(0), y), g.multiply(p(1), x)), g.multiply(p(2), g.power(y, g.constant(3))))};
  source.channels = {{{g.power(g.subtract(g.leaf(LeafKind::measured, 0), y), g.constant(2))}}};
  return source;
}

std::vector<Case> cases() {
  std::vector<double> const duffing = {1, 20, 1e4, 5e9, 1e8};
  return {{"duffing", with_second_channel(systems::duffing()), {.substeps = 1}, duffing, {0, 1, 2, 3, 4}},
          {"duffing, substeps", with_second_channel(systems::duffing()), {.substeps = 3}, duffing, {0, 2, 4}},
          {"bouc_wen with a power", systems::bouc_wen(0), {.substeps = 1}, {2, 10, 5e4, 0.8, -1.1, 1.5}, {0, 1, 2, 3, 4, 5}},
          {"chain", systems::chain(3), {.substeps = 2}, {1, 2, 400, 410, 420, 1e3}, {0, 1, 2, 3, 4, 5}},
          {"linear chain", systems::linear_chain(3), {.method = "exponential"}, {1, 2, 400, 410, 420, 1e3}, {0, 1, 2, 3, 4, 5}},
          {"linear chain, some parameters", systems::linear_chain(2), {.method = "exponential"}, {1, 2, 400, 410, 1e3}, {1, 3}},
          {"linear chain, unequal steps",
           systems::linear_chain(2),
           {.method = "exponential"},
           {1, 2, 400, 410, 1e3},
           {0, 1, 2, 4},
           true},
          {"map", map(), {.substeps = 1}, {0.5, 0.02, 0.1, 0.3}, {0, 1, 2, 3}}};
}

Experiment record_with_gaps(bool unequal = false) {
  auto const input = [](double t) { return 10 * std::sin(300 * t) + 5 * std::cos(77 * t); };
  auto const channel = [](double t) { return 1e-4 * std::sin(90 * t); };
  Experiment record = testing::experiment(unequal ? testing::unequal_times(210, 0.001) : testing::uniform_times(210, 0.001),
                                          {input}, {channel, channel});
  for (int const i : {0, 7, 63, 64, 128}) record.measured[0][static_cast<std::size_t>(i)] = std::nan("");
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
  return parameters;
}

}  // namespace

TEST_CASE("adjoints of random programs are the sums of their tangents") {
  std::vector<int> const by = {0, 1, 2};
  SolverSettings solver;
  int programs = 0, only_tangents = 0;
  for (std::uint64_t index = 0; programs < 500; ++index) {
    CAPTURE(index);
    Stream stream({.seed = 21, .purpose = Purpose::test, .index = index, .step = 0});
    SimulationSource source = testing::random_sources::random_source(stream);
    source.records.clear();
    REQUIRE(has_adjoint(source));
    LaneArray const parameters = column({0.4 + stream.uniform(), 1.1 + stream.uniform(), -0.3 - stream.uniform()});
    solver.method = source.integrator;
    Experiment const record = testing::random_sources::record();
    LaneArray const expected = tangents(source, by, record, solver, parameters);
    if (!std::isfinite(expected(0, 0))) continue;
    ++programs;
    Gradients const found = gradients(source, by, record, solver, parameters);
    if (!found.outcome[0].ok) {  // a branch not taken has an infinite slope
      ++only_tangents;
      continue;
    }
    int const sums = static_cast<int>(source.channels.front().sums.size());
    double size = 0;
    for (int s = 0; s < sums; ++s) {
      CHECK(found.sums(s, 0) == relative(expected(s, 0), 1e-12));
      for (int k = 0; k < 3; ++k) size = std::max(size, std::fabs(expected(sums * (1 + k) + s, 0)));
    }
    for (int k = 0; k < 3; ++k) {
      double sum = 0;
      for (int s = 0; s < sums; ++s) sum += expected(sums * (1 + k) + s, 0);
      CHECK(std::fabs(found.slopes(k, 0) - sum) <= 1e-10 * std::max(size, 1e-6));
    }
  }
  CHECK(only_tangents <= 10);
}

TEST_CASE("adjoints are tangents over gaps, several channels, substeps, maps and estimated starts") {
  for (Case const& each : cases()) {
    CAPTURE(each.name);
    LaneArray const parameters = around(each.centre, 3);
    Gradients const found = gradients(each.source, each.by, record_with_gaps(each.unequal), each.solver, parameters);
    LaneArray const expected = tangents(each.source, each.by, record_with_gaps(each.unequal), each.solver, parameters);
    auto const count = static_cast<int>(each.by.size());
    for (int w = 0; w < 3; ++w) {
      REQUIRE(found.outcome[static_cast<std::size_t>(w)].ok);
      for (int k = 0; k < count; ++k) {
        double sum = 0;
        int row = 0;
        for (ChannelSource const& channel : each.source.channels) {
          int const sums = static_cast<int>(channel.sums.size());
          for (int s = 0; s < sums; ++s) sum += expected(row + sums * (1 + k) + s, w);
          row += sums * (1 + count);
        }
        CHECK(sum != 0);
        CHECK(found.slopes(k, w) == relative(sum, 1e-10));
      }
    }
  }
}

TEST_CASE("adjoints are the same bytes for any executor, lanes, threads and tape") {
  REQUIRE((native::module() != nullptr || narrowest_instruction_set == InstructionSet::neon));  // which has no such compiler
  constexpr int width = 21;
  InstructionSet const before = instruction_set();
  std::vector<ExecutionOptions> ways = {{.lanes = 4, .executor = ExecutorKind::lanes},
                                        {.lanes = 16, .threads = 2, .executor = ExecutorKind::lanes},
                                        {.executor = ExecutorKind::lanes, .tape_bytes = 1}};
  for (int const lanes : {1, 4, 8, 16, 32}) ways.push_back({.lanes = lanes, .executor = ExecutorKind::native});
  ways.push_back({.threads = 2, .executor = ExecutorKind::native, .tape_bytes = 1});
  std::size_t number = 0;  // of the case
  for (Case const& each : cases()) {
    ++number;
    LaneArray parameters = around(each.centre, width);
    parameters(each.source.map ? 0 : 2, 5) = -1e12;  // fails on its way, beside others that must not feel it
    Gradients const oracle = gradients(each.source, each.by, record_with_gaps(each.unequal), each.solver, parameters,
                                       {.executor = ExecutorKind::scalar, .tape_bytes = std::size_t{1} << 30});
    CHECK_FALSE(oracle.outcome[5].ok);
    CHECK(oracle.outcome[6].ok);
    for (InstructionSet const set : {narrowest_instruction_set, InstructionSet::avx512}) {
      if (set > *supported_instruction_set()) continue;
      force_instruction_set(set);
      for (std::size_t way = 0; way < ways.size(); ++way) {
        // Each way with each instruction set for every third case: a way that goes astray does so for many programs.
        if (!full_size() && (way + number + (set == narrowest_instruction_set ? 0 : 1)) % 3 != 0) continue;
        CAPTURE(each.name);
        CAPTURE(way);
        Gradients const found = gradients(each.source, each.by, record_with_gaps(each.unequal), each.solver, parameters, ways[way]);
        CHECK(same_bytes(found.sums, oracle.sums));
        CHECK(same_bytes(found.slopes, oracle.slopes));
      }
    }
    force_instruction_set(before);
  }
}

TEST_CASE("a program that remembers samples has no adjoint") {
  SimulationSource source = systems::duffing();
  CHECK(has_adjoint(source));
  source.memories = {source.graph.leaf(LeafKind::state, 0)};
  source.derivative.push_back(source.graph.constant(0));
  source.initial.push_back(source.graph.constant(0));
  CHECK_FALSE(has_adjoint(source));
}

}  // namespace adjoint_tests
