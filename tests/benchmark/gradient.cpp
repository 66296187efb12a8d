// What a value with its gradient, by tangents or by the adjoint, or with the normal equations of its residuals costs, in values of
// the same executor: thread processor time, measured in turns, medians of the ratios of each turn. An argument: systems whose names
// begin so.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <numeric>
#include <optional>
#include <string>

#include "cases.hpp"
#include "processor_time.hpp"
#include "program/tangents.hpp"

using namespace benchmark_cases;

namespace {

struct Simulated {
  Simulator simulator;
  LaneArray out, slopes;
  std::vector<Outcome> outcome;

  Simulated(SimulationSource const& source, Experiment const& experiment, int width, ExecutorKind executor)
      : Simulated(std::make_shared<SimulationProgram const>(compile(source)), experiment, width, executor) {}
  Simulated(std::shared_ptr<SimulationProgram const> const& program, Experiment const& experiment, int width, ExecutorKind executor)
      : simulator(program, Schedule(*program, experiment, {.substeps = 1}), {.threads = 1, .executor = executor}),
        out(program->sum_count(), width),
        slopes(program->registers.slopes, width),
        outcome(static_cast<std::size_t>(width)) {}
  void operator()(ConstLanes parameters) {
    Work const work = slopes.rows() > 0 ? simulator.gradients_work(parameters, out, slopes, outcome)
                                        : simulator.sums_work(parameters, out, outcome);
    do_work({&work, 1}, nullptr);
  }
};

enum class Kind { tangents, adjoint, squares };
constexpr Kind kinds[] = {Kind::tangents, Kind::adjoint, Kind::squares};
constexpr char const* names[] = {"tangents", "adjoint", "J'r and J'J"};

SimulationSource differentiated(SimulationSource source, int parameters, Kind kind) {
  std::vector<int> by(static_cast<std::size_t>(parameters));
  std::iota(by.begin(), by.end(), 0);
  if (kind == Kind::squares) return with_squares(std::move(source), by);
  source.records.clear();
  if (kind == Kind::tangents) return with_gradient(std::move(source), by);
  source.adjoint_by = by;
  return source;
}

/// Of one squared residual.
SimulationSource of_squares(SimulationSource source) {
  Graph& g = source.graph;
  NodeId const residual = g.subtract(g.leaf(LeafKind::measured, 0), g.leaf(LeafKind::state, 0));
  source.channels.front().sums = {g.power(residual, g.constant(2))};
  source.records = {residual};
  return source;
}

/// Derivatives by all parameters but the `silent` last ones.
void compare(std::string const& name, SimulationSource const& source, Experiment const& experiment, LaneArray const& parameters,
             int silent, ExecutorKind executor) {
  int const width = parameters.width(), count = source.parameters - silent;
  Simulated value(source, experiment, width, executor);
  value(parameters);
  std::printf("%-20s %-6s %2d lanes %2d parameters", name.c_str(), executor == ExecutorKind::native ? "native" : "lanes", width,
              count);
  bool first = true;
  for (Kind const kind : kinds) {
    bool const large = source.states() * (count + 1) > 300;  // takes minutes to compile
    if (large && kind != Kind::adjoint) continue;
    std::optional<Simulated> with;
    double const compiling =
        processor_time::of([&] { with.emplace(differentiated(source, count, kind), experiment, width, executor); });
    double const first_batch = processor_time::of([&] { (*with)(parameters); });
    std::vector<double> values, ratios;
    int const times = std::max(1, static_cast<int>(0.01 / processor_time::of([&] { value(parameters); })));
    for (int round = 0; round < 15; ++round) {
      double const one = processor_time::of([&] {
        for (int i = 0; i < times; ++i) value(parameters);
      });
      double const both = processor_time::of([&] {
        for (int i = 0; i < times; ++i) (*with)(parameters);
      });
      values.push_back(one / times / width);
      ratios.push_back(both / one);
    }
    if (first) std::printf(", value %7.3f us", 1e6 * processor_time::median(values));
    first = false;
    std::printf(", %s %6.2f values (compiled in %.1f ms, first batch %.1f ms)", names[static_cast<int>(kind)],
                processor_time::median(ratios), 1e3 * compiling, 1e3 * first_batch);
  }
  std::printf("; differences %d\n", 2 * count + 1);
}

}  // namespace

int main(int count, char** arguments) {
  std::string const only = count > 1 ? arguments[1] : "";
  for (ExecutorKind const executor : {ExecutorKind::lanes, ExecutorKind::native})
    for (int const width : {4, 8, 64}) {
      auto const with = [&](std::string const& name, SimulationSource const& source, Case const& of, int silent) {
        if (name.starts_with(only)) compare(name, source, of.experiment, of.parameters(width), silent, executor);
      };
      with("Duffing", of_squares(systems::duffing()), duffing(), 1);
      with("Bouc-Wen n = 2", of_squares(systems::bouc_wen(2)), bouc_wen(), 0);
      with("Bouc-Wen, n too", of_squares(systems::bouc_wen(0)), bouc_wen_with_powers(), 0);
      for (int const masses : {2, 5, 10, 20})
        with("chain of " + std::to_string(masses), measured_chain(masses), chain_case(masses), 0);
    }
}
