// What somebody at the prompt waits for: its first line, and completion.
#include <benchmark/benchmark.h>

#include <filesystem>
#include <sstream>

#include "core/system/files.hpp"
#include "core/system/progress.hpp"
#include "repl/completion.hpp"
#include "repl/workbench.hpp"

namespace {

using namespace sysid;

/// A session in the folder of the Silverbox, its output thrown away.
struct Session {
  SilentProgress progress;
  std::ostringstream answers, messages;
  repl::Workbench workbench{RunOptions{}, progress, {answers, messages}};
};

std::string const silverbox = SYSID_SOURCE_DIR "/models/silverbox/silverbox.sysid";

/// All that is done before the first prompt, but the start of the process (./sysid repl </dev/null measures both).
void first_prompt(benchmark::State& state) {
  for (auto _ : state) {
    Session session;
    benchmark::DoNotOptimize(session.workbench.complete(""));
  }
}

/// Of a file that is given on the command line.
void first_prompt_with_file(benchmark::State& state) {
  for (auto _ : state) {
    Session session;
    if (!session.workbench.enter("load \"" + silverbox + "\"")) return state.SkipWithError("the file is not loaded");
  }
}

void completion(benchmark::State& state, char const* entry) {
  Session session;
  session.workbench.enter("load \"" + silverbox + "\"");
  if (repl::completions(session.workbench, entry).words.empty()) return state.SkipWithError("nothing is offered");
  for (auto _ : state) benchmark::DoNotOptimize(repl::completions(session.workbench, entry));
}

BENCHMARK(first_prompt)->Unit(benchmark::kMillisecond);
BENCHMARK(first_prompt_with_file)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(completion, keyword, "par")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(completion, name, "parameter k3 ~ log_u")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(completion, task, "again = fit silv")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(completion, column, "measure displacement = ")->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
