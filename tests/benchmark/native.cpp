// Time per trajectory of machine code, beside the interpreter in lanes and the hand-written loops: thread processor time, measured
// in turns so that all see the same machine, medians of the ratios of each turn.
#include <algorithm>
#include <cstdio>
#include <functional>

#include "cases.hpp"
#include "core/numeric/instruction_set.hpp"
#include "native/module.hpp"
#include "processor_time.hpp"
#include "program/interpreter/executor.hpp"

using namespace benchmark_cases;

namespace {

/// Microseconds per trajectory of each contestant in each turn.
class Turns {
 public:
  explicit Turns(int trajectories) : trajectories_(trajectories) {}
  void add(std::function<void()> work) {
    work();  // once beforehand: compiles, fills caches
    works_.push_back(std::move(work));
    times_.emplace_back();
  }
  void run(int turns) {
    for (int turn = 0; turn < turns; ++turn)
      for (std::size_t i = 0; i < works_.size(); ++i) {
        double const begin = processor_time::seconds();
        works_[i]();
        times_[i].push_back(1e6 * (processor_time::seconds() - begin) / trajectories_);
      }
  }
  double time(std::size_t i) const { return processor_time::median(times_[i]); }
  double ratio(std::size_t i, std::size_t to) const {
    std::vector<double> ratios;
    for (std::size_t turn = 0; turn < times_[i].size(); ++turn) ratios.push_back(times_[i][turn] / times_[to][turn]);
    return processor_time::median(ratios);
  }

 private:
  int trajectories_;
  std::vector<std::function<void()>> works_;
  std::vector<std::vector<double>> times_;
};

std::function<void()> batches(Case const& each, LaneArray const& parameters, int width, int lanes, ExecutorKind kind) {
  auto const simulator = std::make_shared<Simulator>(each.program, Schedule(*each.program, each.experiment, {.substeps = 1}),
                                                     ExecutionOptions{.lanes = lanes, .threads = 1, .executor = kind});
  return [&parameters, width, simulator, sums = LaneArray(each.program->sum_count(), width),
          outcome = std::vector<Outcome>(static_cast<std::size_t>(width))]() mutable {
    for (int first = 0; first < parameters.width(); first += width)
      simulator->sums(parameters.view().columns(first, width), sums, outcome);
  };
}

void in_lanes(Case const& each, InstructionSet set) {
  force_instruction_set(set);
  bool const wide = set == InstructionSet::avx512;
  int const trajectories = 512, most = wide ? 64 : 32;
  LaneArray const parameters = each.parameters(trajectories);
  std::vector<double const*> rows;
  for (int r = 0; r < parameters.rows(); ++r) rows.push_back(parameters.row(r).data());
  std::vector<double> sums(trajectories);
  Turns turns(trajectories);
  turns.add([&] { each.simd(each.record, rows.data(), trajectories, sums.data()); });
  turns.add(batches(each, parameters, most, most, ExecutorKind::lanes));
  turns.add(batches(each, parameters, trajectories, 0, ExecutorKind::native));
  turns.add(batches(each, parameters, 8, 8, ExecutorKind::native));
  turns.run(31);
  std::printf("%-34s %-7s hand-written %7.3f us; interpreter %7.3f us, ratio %5.2f; native %7.3f us, ratio %5.3f; 8 lanes %5.2f\n",
              each.name, std::string(name(set)).c_str(), turns.time(0), turns.time(1), turns.ratio(1, 0), turns.time(2),
              turns.ratio(2, 0), turns.ratio(3, 0));
}

void one_by_one(Case const& each) {
  if (each.loop == nullptr) return;
  int const trajectories = 32;
  LaneArray const parameters = each.parameters(trajectories);
  std::vector<std::vector<double>> columns(trajectories);
  for (int w = 0; w < trajectories; ++w)
    for (int r = 0; r < parameters.rows(); ++r) columns[static_cast<std::size_t>(w)].push_back(parameters(r, w));
  double volatile sink = 0;
  Turns turns(trajectories);
  turns.add([&] {
    for (auto const& column : columns) sink = each.loop(each.record, column);
  });
  turns.add(batches(each, parameters, 1, 1, ExecutorKind::native));
  turns.add(batches(each, parameters, 1, 1, ExecutorKind::lanes));
  turns.add(batches(each, parameters, 4, 4, ExecutorKind::native));
  turns.run(61);
  std::printf(
      "%-34s one lane: hand-written %7.3f us; native %7.3f us, ratio %5.3f; interpreter %5.2f; native in four lanes %5.2f\n",
      each.name, turns.time(0), turns.time(1), turns.ratio(1, 0), turns.ratio(2, 0), turns.ratio(3, 0));
}

/// A chain of masses under the record of Duffing's equation: how much is gained where registers do not hold the states.
void chain_of(int masses) {
  Case each = duffing();
  each.program = std::make_shared<SimulationProgram const>(compile(systems::chain(masses)));
  each.centre.assign(static_cast<std::size_t>(masses) + 3, 1e4);
  each.centre[0] = 1;
  each.centre[1] = 2;
  each.centre.back() = 5e9;
  int const trajectories = 128;
  LaneArray const parameters = each.parameters(trajectories);
  std::printf("chain of %d masses, %zu instructions a step:", masses, each.program->step.code.size());
  Turns turns(trajectories);
  turns.add(batches(each, parameters, trajectories, 0, ExecutorKind::lanes));
  for (Executor const& executor : native_executors(instruction_set())) {
    if (executor.width == 1) continue;
    double const begin = processor_time::seconds();
    turns.add(batches(each, parameters, executor.width, executor.width, ExecutorKind::native));
    std::printf(" compiled for %d lanes in %.0f ms;", executor.width, 1e3 * (processor_time::seconds() - begin));
  }
  turns.run(15);
  std::printf("\n  interpreter %.2f us a trajectory; native", turns.time(0));
  for (std::size_t i = 1; i < native_executors(instruction_set()).size(); ++i) std::printf(" %.3f", turns.ratio(i, 0));
  std::printf(" of that\n");
}

/// From the source of a program to its first results: what is waited for.
void until_first_batch() {
  for (int round = 0; round < 5; ++round) {
    double const begin = processor_time::seconds();
    Case const each = duffing();
    double const compiled = processor_time::seconds();
    LaneArray const parameters = each.parameters(32);
    batches(each, parameters, 32, 32, ExecutorKind::native)();
    std::printf("until the first native batch: %5.1f ms, of which the program %4.1f ms%s\n",
                1e3 * (processor_time::seconds() - begin), 1e3 * (compiled - begin), round == 0 ? " (loads the compiler)" : "");
  }
}

}  // namespace

int main() {
  until_first_batch();
  if (native::module() == nullptr) {
    std::printf("no machine code: %s\n", native::why_unavailable().c_str());
    return 1;
  }
  for (int const masses : {2, 5, 10, 20}) chain_of(masses);
  for (Case const& each : {duffing(), bouc_wen(), bouc_wen_with_powers()}) {
    in_lanes(each, *supported_instruction_set());
    one_by_one(each);
  }
}
