// What a trajectory costs with each solver, relative to RK4 with one step per sample in one lane and in 64: thread CPU time in
// turns, medians of the ratios.
#include <algorithm>
#include <cstdio>

#include "cases.hpp"
#include "processor_time.hpp"

using namespace benchmark_cases;

namespace {

struct Contender {
  Contender(Case const& each, SolverSettings const& solver, int width)
      : width(width),
        parameters(each.parameters(width)),
        sums(each.program->sum_count(), width),
        outcome(static_cast<std::size_t>(width)) {
    SimulationSource source = each.program->source;
    source.integrator = solver.method;
    auto const program = std::make_shared<SimulationProgram const>(compile(std::move(source)));
    simulator.emplace(program, Schedule(*program, each.experiment, solver), ExecutionOptions{.lanes = width, .threads = 1});
  }
  double seconds() {
    double const begin = processor_time::seconds();
    simulator->sums(parameters, sums, outcome);
    return (processor_time::seconds() - begin) / width;
  }
  int width;
  LaneArray parameters, sums;
  std::vector<Outcome> outcome;
  std::optional<Simulator> simulator;
};

}  // namespace

int main() {
  for (Case const& each : {duffing(), bouc_wen()}) {
    Contender one(each, {}, 1), lanes(each, {}, 64);
    for (char const* method : {"cvode", "ida"})
      for (double const relative : {1e-6, 1e-8}) {
        SolverSettings const solver{.method = method, .relative = relative};
        Contender other(each, solver, 4);
        std::vector<double> time, to_one, to_lanes;
        for (int round = 0; round < 15; ++round) {
          double const a = other.seconds(), b = one.seconds(), c = lanes.seconds();
          time.push_back(a), to_one.push_back(a / b), to_lanes.push_back(a / c);
        }
        std::printf("%-30s %-30s %8.2f ms, %6.0f x one lane of rk4, %6.0f x 64 lanes\n", each.name, solver.option().c_str(),
                    1e3 * processor_time::median(time), processor_time::median(to_one), processor_time::median(to_lanes));
      }
  }
}
