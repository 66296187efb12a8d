// Google Benchmark of the engine: time per batch by executor, compilation, schedules, and four lockstep chains of a Metropolis
// sampler.
#include <benchmark/benchmark.h>

#include "cases.hpp"
#include "core/numeric/instruction_set.hpp"
#include "program/interpreter/executor.hpp"

using namespace benchmark_cases;

namespace {

void run_batches(benchmark::State& state, Case const& each, InstructionSet set, int width) {
  force_instruction_set(set);
  Simulator const simulator(each.program, Schedule(*each.program, each.experiment, {.substeps = 1}),
                            {.lanes = width, .threads = 1});
  LaneArray const parameters = each.parameters(width);
  LaneArray sums(each.program->sum_count(), width);
  std::vector<Outcome> outcome(static_cast<std::size_t>(width));
  for (auto _ : state) {
    simulator.sums(parameters, sums, outcome);
    benchmark::DoNotOptimize(sums.view().data());
  }
  state.SetItemsProcessed(state.iterations() * width);
}

void hand_written(benchmark::State& state, Case const& each) {
  for (auto _ : state) benchmark::DoNotOptimize(each.loop(each.record, each.centre));
}

void compilation(benchmark::State& state) {
  SimulationSource const source = systems::bouc_wen(2);
  for (auto _ : state) benchmark::DoNotOptimize(compile(source));
}

void schedule(benchmark::State& state, Case const& each) {
  for (auto _ : state) benchmark::DoNotOptimize(Schedule(*each.program, each.experiment, {.substeps = 1}));
}

}  // namespace

int main(int count, char** arguments) {
  static Case const cases[] = {duffing(), bouc_wen(), bouc_wen_with_powers()};
  for (Case const& each : cases) {
    if (each.loop != nullptr)
      benchmark::RegisterBenchmark((std::string(each.name) + "/hand-written").c_str(),
                                   [&](benchmark::State& s) { hand_written(s, each); });
    for (InstructionSet const set : {InstructionSet::avx2, InstructionSet::avx512}) {
      if (set > *supported_instruction_set()) continue;
      for (Executor const& executor : executors(set)) {
        std::string const name =
            std::string(each.name) + "/" + std::string(sysid::name(set)) + "/" + std::to_string(executor.width);
        benchmark::RegisterBenchmark(name.c_str(),
                                     [&each, set, &executor](benchmark::State& s) { run_batches(s, each, set, executor.width); });
      }
    }
  }
  benchmark::RegisterBenchmark("compile Bouc-Wen", compilation);
  benchmark::RegisterBenchmark("schedule of 500 samples", [](benchmark::State& s) { schedule(s, cases[0]); });
  benchmark::Initialize(&count, arguments);
  benchmark::RunSpecifiedBenchmarks();
}
