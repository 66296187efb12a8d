// What a page costs: a run of four chains of 25,000 draws, written with all its files, and made anew from its folder.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <filesystem>

#include "app/run/report_results.hpp"
#include "report/example.hpp"
#include "report/file/task_folder.hpp"
#include "temporary_folder.hpp"

namespace {

using namespace sysid;

/// Processor seconds of this process and of those that it has waited for: gnuplot's.
double processor_seconds() {
  double seconds = 0;
  for (int const who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage = {};
    getrusage(who, &usage);
    for (timeval const& each : {usage.ru_utime, usage.ru_stime})
      seconds += static_cast<double>(each.tv_sec) + 1e-6 * static_cast<double>(each.tv_usec);
  }
  return seconds;
}

template <class Work>
void measure(benchmark::State& state, Work const& work) {
  for (auto _ : state) {
    double const began = processor_seconds();
    work();
    state.SetIterationTime(processor_seconds() - began);
  }
}

Report const& fitted() {
  static Report const report = example::duffing(25000);
  return report;
}

void write(benchmark::State& state) {
  TemporaryFolder const folder;
  measure(state, [&] { write_result(fitted(), folder.path()); });
}
BENCHMARK(write)->UseManualTime()->Unit(benchmark::kSecond);

void report_again(benchmark::State& state) {
  TemporaryFolder const folder;
  write_result(fitted(), folder.path(), {});
  measure(state, [&] { report_results(folder.path(), std::nullopt, state.range(0) != 0); });
}
BENCHMARK(report_again)->ArgName("figures")->Arg(1)->Arg(0)->UseManualTime()->Unit(benchmark::kSecond);

}  // namespace

BENCHMARK_MAIN();
