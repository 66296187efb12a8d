// The two systems of the benchmarks with records and parameters, for the engine and for the hand-written loops.
#pragma once
#include <cmath>
#include <memory>
#include <vector>

#include "baseline.hpp"
#include "core/numeric/elementary.hpp"
#include "core/numeric/random.hpp"
#include "simulate/simulator.hpp"
#include "simulate/systems.hpp"

namespace benchmark_cases {

using namespace sysid;

struct Case {
  char const* name;
  baseline::Record record;
  std::shared_ptr<SimulationProgram const> program;
  Experiment experiment;
  std::vector<double> centre;  // parameters, spread by a few percent over lanes
  /// The hand-written loop; nullptr: there is none.
  double (*loop)(baseline::Record const&, std::vector<double> const&);
  /// The same over lanes.
  void (*simd)(baseline::Record const&, double const* const*, int, double*);

  LaneArray parameters(int width) const {
    LaneArray result(static_cast<int>(centre.size()), width);
    for (int r = 0; r < result.rows(); ++r)
      for (int w = 0; w < width; ++w) {
        Stream stream(
            {.seed = 3, .purpose = Purpose::test, .index = static_cast<std::uint64_t>(w), .step = static_cast<std::uint64_t>(r)});
        result(r, w) = centre[static_cast<std::size_t>(r)] * (1 + 0.02 * stream.normal());
      }
    return result;
  }
};

inline Experiment experiment_of(baseline::Record const& record) {
  Experiment experiment;
  for (std::size_t i = 0; i < record.input.size(); ++i) experiment.time.push_back(record.h * static_cast<double>(i));
  experiment.inputs.emplace_back(InputRule::linear, experiment.time, record.input);
  experiment.measured = {record.measured};
  experiment.scored.assign(record.input.size(), 1);
  return experiment;
}

/// 500 samples at 1 kHz under random force; one RK4 step per sample.
inline Case duffing() {
  baseline::Record record{0.001, {}, {}};
  Stream stream({.seed = 1, .purpose = Purpose::input, .index = 0, .step = 0});
  for (int i = 0; i < 500; ++i) {
    record.input.push_back(10 * stream.normal());
    record.measured.push_back(1e-5 * stream.normal());
  }
  Experiment experiment = experiment_of(record);
  return {"Duffing, 500 samples",
          std::move(record),
          std::make_shared<SimulationProgram const>(compile(systems::duffing())),
          std::move(experiment),
          {1, 20, 1e4, 5e9, 1e10},
          [](baseline::Record const& r, std::vector<double> const& p) { return baseline::duffing(r, p[0], p[1], p[2], p[3]); },
          &baseline::duffing_simd};
}

/// 1001 samples of a sine; n = 2.
inline Case bouc_wen() {
  baseline::Record record{0.004, {}, {}};
  Stream stream({.seed = 2, .purpose = Purpose::input, .index = 0, .step = 0});
  for (int i = 0; i < 1001; ++i) {
    record.input.push_back(120 * elementary::sin(2 * 3.14159265358979 * 0.004 * i));
    record.measured.push_back(1e-4 * stream.normal());
  }
  Experiment experiment = experiment_of(record);
  return {
      "Bouc-Wen n = 2, 1001 samples",
      std::move(record),
      std::make_shared<SimulationProgram const>(compile(systems::bouc_wen(2))),
      std::move(experiment),
      {2, 10, 5e4, 0.8, -1.1},
      [](baseline::Record const& r, std::vector<double> const& p) { return baseline::bouc_wen(r, p[0], p[1], p[2], p[3], p[4]); },
      &baseline::bouc_wen_simd};
}

/// The same record with the exponent n = 1.5 a parameter: powers dominate.
inline Case bouc_wen_with_powers() {
  Case result = bouc_wen();
  result.name = "Bouc-Wen n estimated, 1001 samples";
  result.program = std::make_shared<SimulationProgram const>(compile(systems::bouc_wen(0)));
  result.centre = {2, 10, 5e4, 0.8, -1.1, 1.5};
  result.loop = nullptr;
  result.simd = &baseline::bouc_wen_power_simd;
  return result;
}

/// The chain of `tests/jobs`: 2 n + 3 parameters m(n), k(n), alpha, beta, precision; measured at every mass.
inline SimulationSource measured_chain(int masses) {
  SimulationSource source;
  Graph& g = source.graph;
  auto const p = [&](int i) { return g.leaf(LeafKind::parameter, i); };
  auto const state = [&](int i, int which) { return i < 0 ? g.constant(0) : g.leaf(LeafKind::state, 2 * i + which); };
  auto const force = [&](int i) {  // of the spring before mass i
    if (i >= masses) return g.constant(0);
    NodeId const stretch = g.subtract(state(i, 0), state(i - 1, 0)), rate = g.subtract(state(i, 1), state(i - 1, 1));
    return g.multiply(p(masses + i), g.add(stretch, g.multiply(p(2 * masses + 1), rate)));
  };
  source.parameters = 2 * masses + 3;
  source.inputs = 1;
  for (int i = 0; i < masses; ++i) {
    NodeId const load = i + 1 == masses ? g.leaf(LeafKind::input, 0) : g.constant(0);
    NodeId const pull = g.add(g.subtract(load, force(i)), force(i + 1));
    source.initial.insert(source.initial.end(), {g.constant(0), g.constant(0)});
    source.derivative.insert(source.derivative.end(),
                             {state(i, 1), g.subtract(g.divide(pull, p(i)), g.multiply(p(2 * masses), state(i, 1)))});
    NodeId const precision = p(2 * masses + 2);
    source.channels.push_back({{systems::normal_log_density(g, i, state(i, 0), precision)}});
    source.records.push_back(
        g.multiply(g.unary(Operation::square_root, precision), g.subtract(g.leaf(LeafKind::measured, i), state(i, 0))));
  }
  return source;
}

inline Case chain_case(int masses) {
  Case chain = duffing();
  chain.record.h = 0.0005;
  chain.experiment = experiment_of(chain.record);
  chain.experiment.measured.assign(static_cast<std::size_t>(masses), chain.record.measured);
  chain.centre.assign(static_cast<std::size_t>(masses), 1);
  for (int i = 0; i < masses; ++i) chain.centre.push_back(1e4 + 500 * (i % 3));
  chain.centre.insert(chain.centre.end(), {0.5, 5e-4, 1e8});
  return chain;
}

}  // namespace benchmark_cases
