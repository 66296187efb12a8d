// What a trajectory costs with each solver, relative to RK4 with one step per sample in one lane and in 64: thread CPU time in
// turns, medians of the ratios. Then linear chains of masses with exact steps and with RK4, values and gradients; and the same
// along records whose steps differ in length.
#include <algorithm>
#include <cstdio>
#include <string_view>
#include <utility>

#include "cases.hpp"
#include "processor_time.hpp"
#include "simulate/experiments.hpp"

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

std::vector<double> equal_steps(int samples) { return testing::uniform_times(samples, 0.01); }

/// Every tenth interval is four times as long.
std::vector<double> with_gaps(int samples) {
  std::vector<double> time{0};
  for (int i = 1; i < samples; ++i) time.push_back(time.back() + (i % 10 == 0 ? 0.04 : 0.01));
  return time;
}

std::vector<double> all_different(int samples) {
  Stream stream({.seed = 2, .purpose = Purpose::input, .index = 0, .step = 0});
  std::vector<double> time{0};
  for (int i = 1; i < samples; ++i) time.push_back(time.back() + 0.005 + 0.01 * stream.uniform());
  return time;
}

/// Values, or values with their gradient by all parameters.
struct Linear {
  Linear(int masses, std::vector<double> const& time, SolverSettings const& solver, bool gradient, ExecutorKind executor) {
    SimulationSource source = systems::linear_chain(masses);
    source.integrator = solver.method;
    source.records.clear();
    if (gradient)
      for (int p = 0; p < source.parameters; ++p) source.adjoint_by.push_back(p);
    Stream stream({.seed = 1, .purpose = Purpose::input, .index = 0, .step = 0});
    Experiment const experiment =
        testing::experiment(time, {[&](double) { return 10 * stream.normal(); }}, {[&](double) { return 1e-5 * stream.normal(); }});
    auto const program = std::make_shared<SimulationProgram const>(compile(source));
    parameters = LaneArray(source.parameters, width);
    for (int p = 0; p < source.parameters; ++p)
      for (int w = 0; w < width; ++w) {
        double const centre = p == 0 ? 1 : p == 1 ? 2 : p + 1 < source.parameters ? 400 + 10 * p : 1e8;
        parameters(p, w) = centre * (1 + 0.001 * w);
      }
    sums = LaneArray(program->sum_count(), width);
    slopes = LaneArray(static_cast<int>(source.adjoint_by.size()), width);
    simulator.emplace(program, Schedule(*program, experiment, solver), ExecutionOptions{.threads = 1, .executor = executor});
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

/// Medians: of the seconds of one, and of their ratio to those of the other.
std::pair<double, double> in_turns(Linear& one, Linear& other) {
  std::vector<double> time, ratio;
  for (int round = 0; round < 15; ++round) {
    double const a = one.seconds(), b = other.seconds();
    if (round < 4) continue;  // machine code is compiled
    time.push_back(a), ratio.push_back(a / b);
  }
  return {processor_time::median(time), processor_time::median(ratio)};
}

void compare_linear() {
  for (ExecutorKind const executor : {ExecutorKind::lanes, ExecutorKind::native})
    for (bool const gradient : {false, true})
      for (int const masses : {1, 2, 4})
        for (int const samples : {500, 5000}) {
          std::vector<double> const steps = equal_steps(samples);
          Linear exact(masses, steps, {.method = "exponential"}, gradient, executor), fixed(masses, steps, {}, gradient, executor);
          auto const [time, ratio] = in_turns(exact, fixed);
          std::printf("%d states, %4d samples, %-9s %-12s exponential %8.1f us, %5.2f x rk4(substeps = 1)\n", 2 * masses, samples,
                      gradient ? "gradient," : "value,",
                      executor == ExecutorKind::lanes ? "interpreted:" : "machine code:", 1e6 * time, ratio);
        }
}

void compare_lengths() {
  struct Spacing {
    char const* name;
    std::vector<double> (*times)(int samples);
  };
  for (bool const gradient : {false, true})
    for (int const masses : {1, 2, 5})
      for (Spacing const& spacing : {Spacing{"equal", &equal_steps}, {"gaps", &with_gaps}, {"all different", &all_different}}) {
        std::vector<double> const steps = spacing.times(1000);
        Linear exact(masses, steps, {.method = "exponential"}, gradient, ExecutorKind::native),
            one(masses, steps, {}, gradient, ExecutorKind::native),
            sixteen(masses, steps, {.substeps = 16}, gradient, ExecutorKind::native);
        auto const [time, by_one] = in_turns(exact, one);
        auto const [_, by_sixteen] = in_turns(exact, sixteen);
        std::printf("%2d states, %-14s %-9s exponential %8.1f us, %7.2f x rk4(substeps = 1), %6.2f x rk4(substeps = 16)\n",
                    2 * masses, spacing.name, gradient ? "gradient," : "value,", 1e6 * time, by_one, by_sixteen);
        std::fflush(stdout);
      }
}

}  // namespace

int main(int count, char** arguments) {
  if (count > 1 && std::string_view(arguments[1]) == "lengths") return compare_lengths(), 0;
  if (count > 1) return compare_linear(), 0;  // any other argument: these alone
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
  compare_lengths();
}
