// What a value with its gradient, or with the normal equations of its residuals, by tangents costs, in values of the same executor:
// thread processor time, measured in turns, medians of the ratios of each turn.
#include <ctime>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <numeric>
#include <optional>
#include <string>

#include "cases.hpp"
#include "program/tangents.hpp"

using namespace benchmark_cases;

namespace {

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double timed(std::function<void()> const& work) {
  double const begin = cpu_seconds();
  work();
  return cpu_seconds() - begin;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

struct Sums {
  Simulator simulator;
  LaneArray out;
  std::vector<Outcome> outcome;

  Sums(SimulationSource const& source, Experiment const& experiment, int width, ExecutorKind executor)
      : Sums(std::make_shared<SimulationProgram const>(compile(source)), experiment, width, executor) {}
  Sums(std::shared_ptr<SimulationProgram const> const& program, Experiment const& experiment, int width, ExecutorKind executor)
      : simulator(program, Schedule(*program, experiment, {.substeps = 1}), {.threads = 1, .executor = executor}),
        out(program->sum_count(), width),
        outcome(static_cast<std::size_t>(width)) {}
  void operator()(ConstLanes parameters) { simulator.sums(parameters, out, outcome); }
};

/// The source with one sum, the squared residual, and its gradient; with the normal equations as well, or without.
SimulationSource differentiated(SimulationSource source, int parameters, bool squares) {
  Graph& g = source.graph;
  NodeId const residual = g.subtract(g.leaf(LeafKind::measured, 0), g.leaf(LeafKind::state, 0));
  source.channels.front().sums = {g.power(residual, g.constant(2))};
  source.records = {squares ? residual : g.constant(0)};
  std::vector<int> by(static_cast<std::size_t>(parameters));
  std::iota(by.begin(), by.end(), 0);
  return with_squares(std::move(source), by);
}

/// Derivatives by all parameters but the `silent` last ones.
void compare(std::string const& name, SimulationSource const& source, Experiment const& experiment, LaneArray const& parameters,
             int silent, ExecutorKind executor) {
  int const width = parameters.width(), count = source.parameters - silent;
  Sums value(source, experiment, width, executor);
  value(parameters);
  std::printf("%-20s %-6s %2d parameters", name.c_str(), executor == ExecutorKind::native ? "native" : "lanes", count);
  for (bool const squares : {false, true}) {
    std::optional<Sums> with;
    double const compiling = timed([&] { with.emplace(differentiated(source, count, squares), experiment, width, executor); });
    double const first = timed([&] { (*with)(parameters); });
    std::vector<double> values, ratios;
    int const times = std::max(1, static_cast<int>(0.01 / timed([&] { value(parameters); })));
    for (int round = 0; round < 15; ++round) {
      double const one = timed([&] {
        for (int i = 0; i < times; ++i) value(parameters);
      });
      double const both = timed([&] {
        for (int i = 0; i < times; ++i) (*with)(parameters);
      });
      values.push_back(one / times / width);
      ratios.push_back(both / one);
    }
    if (!squares) std::printf(", value %7.3f us", 1e6 * median(values));
    std::printf(", %s %6.2f values (compiled in %.1f ms, first batch %.1f ms)", squares ? "normal equations" : "gradient",
                median(ratios), 1e3 * compiling, 1e3 * first);
  }
  std::printf("; differences %d\n", 2 * count + 1);
}

}  // namespace

int main() {
  constexpr int width = 64;
  for (ExecutorKind const executor : {ExecutorKind::lanes, ExecutorKind::native}) {
    Case const oscillator = duffing(), hysteresis = bouc_wen(), powers = bouc_wen_with_powers();
    compare("Duffing", systems::duffing(), oscillator.experiment, oscillator.parameters(width), 1, executor);
    compare("Bouc-Wen n = 2", systems::bouc_wen(2), hysteresis.experiment, hysteresis.parameters(width), 0, executor);
    compare("Bouc-Wen, n too", systems::bouc_wen(0), powers.experiment, powers.parameters(width), 0, executor);
    for (int const masses : {2, 5, 7, 10, 20}) {
      std::vector<double> centre = {1, 2};
      for (int i = 0; i < masses; ++i) centre.push_back(400 + 10 * i);
      centre.push_back(1e3);
      Case chain = duffing();
      chain.centre = centre;
      compare("chain of " + std::to_string(masses), systems::chain(masses), chain.experiment, chain.parameters(width), 0, executor);
    }
  }
}
