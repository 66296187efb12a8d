// How long somebody at the prompt waits: for the first prompt, in a process of its own behind a pseudo-terminal, and for Tab.
#include <benchmark/benchmark.h>

#include <filesystem>
#include <sstream>

#include "repl/completion.hpp"
#include "repl/pseudo_terminal.hpp"
#include "repl/workbench.hpp"
#include "temporary_folder.hpp"

using namespace sysid;

namespace {

/// From a fork of this process: less the loading of the program, which `sysid version` shows to be some milliseconds.
void first_prompt(benchmark::State& state) {
  TemporaryFolder const folder;
  for (auto each : state) {
    PseudoTerminal terminal(folder.path());
    benchmark::DoNotOptimize(terminal.until(terminal.prompt));
  }
}
BENCHMARK(first_prompt)->Unit(benchmark::kMillisecond)->UseRealTime();

void completion(benchmark::State& state, std::string const& entry) {
  SilentProgress silent;
  std::ostringstream nowhere;
  repl::Workbench workbench({}, silent, {nowhere, nowhere});
  workbench.enter("load \"" SYSID_SOURCE_DIR "/models/silverbox/silverbox.sysid\"");
  for (auto each : state) benchmark::DoNotOptimize(repl::completions(workbench, entry));
}
BENCHMARK_CAPTURE(completion, words, "parameter k ~ log")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(completion, names, "f = fit sil")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(completion, columns, "measure output = ")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(completion, files, "load " SYSID_SOURCE_DIR "/models/")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(completion, help, "help ")->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
