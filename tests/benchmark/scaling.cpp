// How the time of a simulation grows with lanes, samples, states, parameters and threads: blocks of columns that scaling.gnuplot
// draws. Processor time of the thread, medians of turns; for threads the time by the clock, which other work on the machine spoils.
#include <chrono>
#include <cstdio>
#include <functional>
#include <string>

#include "cases.hpp"
#include "processor_time.hpp"

using namespace benchmark_cases;

namespace {

constexpr int turns = 11;

/// Microseconds of `work`, repeated until it takes ten milliseconds.
double microseconds(std::function<void()> const& work) {
  work();  // compiles, fills caches
  int const times = std::max(1, static_cast<int>(0.01 / processor_time::of(work)));
  std::vector<double> values;
  for (int turn = 0; turn < turns; ++turn)
    values.push_back(1e6 / times * processor_time::of([&] {
                       for (int i = 0; i < times; ++i) work();
                     }));
  return processor_time::median(values);
}

/// Sums of `width` trajectories.
std::function<void()> batch(Case const& each, int width, ExecutionOptions options) {
  auto const simulator =
      std::make_shared<Simulator>(each.program, Schedule(*each.program, each.experiment, {.substeps = 1}), options);
  return
      [simulator, parameters = each.parameters(width), sums = LaneArray(each.program->sum_count(), width),
       outcome = std::vector<Outcome>(static_cast<std::size_t>(width))]() mutable { simulator->sums(parameters, sums, outcome); };
}

/// Microseconds a trajectory: interpreted, and in machine code.
void row(double x, Case const& each, int width, int lanes) {
  std::printf("%g", x);
  for (ExecutorKind const kind : {ExecutorKind::lanes, ExecutorKind::native})
    std::printf(" %.4g", microseconds(batch(each, width, {.lanes = lanes, .threads = 1, .executor = kind})) / width);
  std::printf("\n");
  std::fflush(stdout);
}

Case duffing_of(int samples) {
  Case each = duffing();
  while (static_cast<int>(each.record.input.size()) < samples) {
    std::size_t const i = each.record.input.size();
    each.record.input.push_back(each.record.input[i % 500]);
    each.record.measured.push_back(each.record.measured[i % 500]);
  }
  each.record.input.resize(static_cast<std::size_t>(samples));
  each.record.measured.resize(static_cast<std::size_t>(samples));
  each.experiment = experiment_of(each.record);
  return each;
}

Case chain_of(int masses) {
  Case each = duffing();
  each.program = std::make_shared<SimulationProgram const>(compile(systems::chain(masses)));
  each.centre = {1, 2};
  for (int i = 0; i < masses; ++i) each.centre.push_back(400 + 10 * i);
  each.centre.push_back(1e3);
  return each;
}

void threads() {
  Case const each = duffing();
  constexpr int width = 4096;
  double one = 0;
  for (int const count : {1, 2, 4, 8, 16}) {
    auto const work = batch(each, width, {.threads = count});
    work();
    std::vector<double> values;
    for (int turn = 0; turn < turns; ++turn) {
      auto const begin = std::chrono::steady_clock::now();
      work();
      values.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    double const now = processor_time::median(values);
    if (count == 1) one = now;
    std::printf("%d %.4g\n", count, one / now);
  }
}

}  // namespace

int main() {
  std::printf("# lanes: microseconds a trajectory, interpreted and in machine code\n");
  for (int const lanes : {4, 8, 16, 32, 64}) row(lanes, duffing(), lanes, lanes);
  std::printf("\n\n# samples\n");
  for (int const samples : {100, 300, 1000, 3000, 10000, 30000, 100000}) row(samples, duffing_of(samples), 64, 0);
  std::printf("\n\n# states of chains of masses\n");
  for (int const masses : {1, 2, 4, 8, 16, 32}) row(2 * masses, chain_of(masses), 64, 0);
  std::printf("\n\n# threads: times as fast as one\n");
  threads();
}
