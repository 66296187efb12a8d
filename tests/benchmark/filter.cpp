// What the likelihood of a filter costs, in likelihoods of the same model without a disturbance, by the same executor: chains of
// masses, a white force on the last one; thread processor time, measured in turns, medians of the ratios of each turn.
#include <algorithm>
#include <cstdio>
#include <functional>

#include "cases.hpp"
#include "processor_time.hpp"
#include "program/moments/moments.hpp"

using namespace benchmark_cases;

namespace {

struct Simulated {
  Simulator simulator;
  LaneArray out;
  std::vector<Outcome> outcome;

  Simulated(SimulationSource source, Experiment const& experiment, int width)
      : Simulated(std::make_shared<SimulationProgram const>(compile(std::move(source))), experiment, width) {}
  Simulated(std::shared_ptr<SimulationProgram const> const& program, Experiment const& experiment, int width)
      : simulator(program, Schedule(*program, experiment, {.substeps = 1}), {.threads = 1, .executor = ExecutorKind::native}),
        out(program->sum_count(), width),
        outcome(static_cast<std::size_t>(width)) {}
  void operator()(ConstLanes parameters) { simulator.sums(parameters, out, outcome); }
};

/// The filter of the source with a white force on the last mass, as the model's likelihood has it.
SimulationSource filtered(SimulationSource source, int masses) {
  Graph& g = source.graph;
  NodeId const force = g.divide(g.leaf(LeafKind::disturbance, 0), g.leaf(LeafKind::parameter, masses - 1));
  source.derivative.back() = g.add(source.derivative.back(), force);
  NodeId const variance = g.divide(g.constant(1), g.leaf(LeafKind::parameter, 2 * masses + 2));
  std::vector<NormalChannel> channels;
  for (std::size_t c = 0; c < source.channels.size(); ++c)
    channels.push_back({g.leaf(LeafKind::state, 2 * static_cast<int>(c)), variance});
  RandomStates random;
  random.noises.push_back({g.constant(1e-3), false});
  random.initial_variances.resize(source.derivative.size());
  random.by_slopes = true;
  source.channels.clear();
  source.records.clear();
  Moments moments = with_moments(std::move(source), random, channels, MomentRule::linearised);
  Graph& grown = moments.source.graph;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    Innovation const& expected = moments.channels[c];
    NodeId const precision = grown.divide(grown.constant(1), expected.variance);
    moments.source.channels.push_back(
        {{systems::normal_log_density(grown, static_cast<int>(c), expected.mean, precision)}, expected.correct, false});
  }
  return std::move(moments.source);
}

void compare(int masses, int channels) {
  Case const chain = chain_case(masses);
  SimulationSource source = measured_chain(masses);
  source.channels.resize(static_cast<std::size_t>(channels));
  source.records.clear();
  Experiment experiment = chain.experiment;
  experiment.measured.resize(static_cast<std::size_t>(channels));
  LaneArray const parameters = chain.parameters(64);
  Simulated plain(source, experiment, 64), filter(filtered(source, masses), experiment, 64);
  plain(parameters);
  filter(parameters);
  int const times = std::max(1, static_cast<int>(0.01 / processor_time::of([&] { plain(parameters); })));
  std::vector<double> ratios, microseconds;
  for (int round = 0; round < 15; ++round) {
    double const one = processor_time::of([&] {
      for (int i = 0; i < times; ++i) plain(parameters);
    });
    double const other = processor_time::of([&] {
      for (int i = 0; i < times; ++i) filter(parameters);
    });
    ratios.push_back(other / one);
    microseconds.push_back(1e6 * other / times / 64);
  }
  std::printf("%2d states, %2d of filter, %d channels: %6.2f times a value, %8.1f us\n", 2 * masses,
              filter.simulator.program().registers.states, channels, processor_time::median(ratios),
              processor_time::median(microseconds));
  std::fflush(stdout);
}

}  // namespace

int main() {
  for (int const masses : {1, 2, 3, 5}) {
    compare(masses, 1);
    if (masses > 1) compare(masses, masses);
  }
}
