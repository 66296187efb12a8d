// Time per trajectory of the lane bytecode over that of the hand-written scalar loop: thread CPU time, measured in turns so that
// both see the same machine, medians of the ratios of each turn.
#include <algorithm>
#include <cstdio>
#include <functional>

#include "cases.hpp"
#include "core/numeric/instruction_set.hpp"
#include "processor_time.hpp"
#include "program/interpreter/executor.hpp"

using namespace benchmark_cases;

namespace {

double volatile sink;

void compare(Case const& each, InstructionSet set, int width) {
  force_instruction_set(set);
  int const trajectories = 512;
  LaneArray const parameters = each.parameters(trajectories);
  std::vector<std::vector<double>> columns;
  for (int w = 0; w < trajectories; ++w) {
    columns.emplace_back();
    for (int r = 0; r < parameters.rows(); ++r) columns.back().push_back(parameters(r, w));
  }
  Simulator const simulator(each.program, Schedule(*each.program, each.experiment, {.substeps = 1}),
                            {.lanes = width, .threads = 1});
  LaneArray sums(each.program->sum_count(), width);
  std::vector<Outcome> outcome(static_cast<std::size_t>(width));
  int const batches = std::max(1, trajectories / 4 / width);
  std::vector<double> ratios, engine, loop;
  for (int round = 0; round < 40; ++round) {
    double const a = processor_time::of([&] {
                       for (int b = 0; b < batches; ++b)
                         simulator.sums(parameters.view().columns(b * width % trajectories, width), sums, outcome);
                     }) /
                     (batches * width);
    double const b = processor_time::of([&] {
                       for (int w = 0; w < 32; ++w)
                         sink = each.loop(each.record, columns[static_cast<std::size_t>((round * 32 + w) % trajectories)]);
                     }) /
                     32;
    engine.push_back(a);
    loop.push_back(b);
    ratios.push_back(a / b);
  }
  std::printf("%-30s %-7s W=%-3d  %8.3f us per trajectory, %8.1f us per batch; loop %7.3f us; ratio %.3f\n", each.name,
              std::string(name(set)).c_str(), width, 1e6 * processor_time::median(engine),
              1e6 * processor_time::median(engine) * width, 1e6 * processor_time::median(loop), processor_time::median(ratios));
}

}  // namespace

int main() {
  for (Case const& each : {duffing(), bouc_wen()}) {
    for (InstructionSet const set : {InstructionSet::avx512, InstructionSet::avx2}) {
      if (set > *supported_instruction_set()) continue;
      for (Executor const& executor : executors(set)) compare(each, set, executor.width);
    }
  }
}
