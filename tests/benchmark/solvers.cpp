// What a trajectory costs with each solver, relative to RK4 with one step per sample in one lane and in 64: thread CPU time in
// turns, medians of the ratios. Then linear chains of masses with exact steps and with RK4, values and gradients.
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

/// Values, or values with their gradient by all parameters.
struct Linear {
  Linear(int masses, int samples, std::string const& method, bool gradient, ExecutorKind executor) {
    SimulationSource source = systems::linear_chain(masses);
    source.integrator = method;
    source.records.clear();
    if (gradient)
      for (int p = 0; p < source.parameters; ++p) source.adjoint_by.push_back(p);
    baseline::Record record{0.01, {}, {}};
    Stream stream({.seed = 1, .purpose = Purpose::input, .index = 0, .step = 0});
    for (int i = 0; i < samples; ++i) {
      record.input.push_back(10 * stream.normal());
      record.measured.push_back(1e-5 * stream.normal());
    }
    auto const program = std::make_shared<SimulationProgram const>(compile(source));
    parameters = LaneArray(source.parameters, width);
    for (int p = 0; p < source.parameters; ++p)
      for (int w = 0; w < width; ++w) {
        double const centre = p == 0 ? 1 : p == 1 ? 2 : p + 1 < source.parameters ? 400 + 10 * p : 1e8;
        parameters(p, w) = centre * (1 + 0.001 * w);
      }
    sums = LaneArray(program->sum_count(), width);
    slopes = LaneArray(static_cast<int>(source.adjoint_by.size()), width);
    simulator.emplace(program, Schedule(*program, experiment_of(record), {.method = method}),
                      ExecutionOptions{.threads = 1, .executor = executor});
  }
  double seconds() {
    double const begin = processor_time::seconds();
    Work const work = slopes.rows() > 0 ? simulator->gradients_work(parameters, sums, slopes, outcome)
                                        : simulator->sums_work(parameters, sums, outcome);
    do_work({&work, 1}, nullptr);
    return (processor_time::seconds() - begin) / width;
  }
  static constexpr int width = 16;
  LaneArray parameters{0, 0}, sums{0, 0}, slopes{0, 0};
  std::vector<Outcome> outcome = std::vector<Outcome>(width);
  std::optional<Simulator> simulator;
};

void compare_linear() {
  for (ExecutorKind const executor : {ExecutorKind::lanes, ExecutorKind::native})
    for (bool const gradient : {false, true})
      for (int const masses : {1, 2, 4})
        for (int const samples : {500, 5000}) {
          Linear exact(masses, samples, "exponential", gradient, executor), fixed(masses, samples, "rk4", gradient, executor);
          std::vector<double> time, ratio;
          for (int round = 0; round < 25; ++round) {
            double const a = exact.seconds(), b = fixed.seconds();
            if (round < 4) continue;  // machine code is compiled
            time.push_back(a), ratio.push_back(a / b);
          }
          std::printf("%d states, %4d samples, %-9s %-12s exponential %8.1f us, %5.2f x rk4(substeps = 1)\n", 2 * masses, samples,
                      gradient ? "gradient," : "value,",
                      executor == ExecutorKind::lanes ? "interpreted:" : "machine code:", 1e6 * processor_time::median(time),
                      processor_time::median(ratio));
        }
}

}  // namespace

int main(int count, char**) {
  if (count > 1) return compare_linear(), 0;  // any argument: these alone
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
  compare_linear();
}
