// What samplers give for their time: effective draws of the worst parameter per second of the thread's processor time, burn-in
// included, the search for modes not. Samplers run in turns on one posterior, with several seeds; medians.
//
//   bench_samplers [FILE [ROUNDS]]        the first fit of a file whose data exist; models/duffing/duffing.sysid, 5 rounds
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "core/system/files.hpp"
#include "experiment/experiments.hpp"
#include "inference/table.hpp"
#include "likelihood/model_target.hpp"
#include "load/load.hpp"
#include "processor_time.hpp"
#include "search/global/search.hpp"

using namespace sysid;

namespace {

/// The posterior of a fit, by its own solver without refinements, on one thread.
std::unique_ptr<ModelTarget> target_of(CheckedFile const& file, FitTask const& fit, std::filesystem::path const& folder) {
  Model const& model = file.models[static_cast<std::size_t>(fit.model)];
  std::vector<Experiment> experiments;
  for (ExperimentUse const& use : fit.experiments) {
    DataBlock const& block = file.data[static_cast<std::size_t>(use.data)];
    experiments.push_back(cut(load_record(block, model, folder), block, model, use.part, fit.start));
  }
  TargetOptions options;
  options.solver = fit.solver;
  options.execution.threads = 1;
  return std::make_unique<ModelTarget>(compile(model, false, fit.solver.method), parameter_space(model, fit.experiments),
                                       std::move(experiments), options);
}

struct Measured {
  std::vector<double> seconds, draws, simulations;
};

void measure(Target const& target, SearchResult const& found, BackendRow const& backend, std::uint64_t seed, Measured& measured) {
  SilentProgress progress;
  Ledger ledger;
  RunContext context{.seed = seed, .progress = progress, .ledger = ledger};
  context.modes = found.modes;
  double const begin = processor_time::seconds();
  FitResult const result = backend.run(target, Settings(backend.settings), context);
  measured.seconds.push_back(processor_time::seconds() - begin);
  double least = HUGE_VAL;
  for (Summary const& each : summarise(result)) least = std::min(least, each.ess_bulk);
  measured.draws.push_back(least);
  measured.simulations.push_back(static_cast<double>(ledger.solves()));
}

}  // namespace

int main(int count, char** arguments) {
  std::filesystem::path const path = count > 1 ? arguments[1] : SYSID_SOURCE_DIR "/models/duffing/duffing.sysid";
  int const rounds = count > 2 ? std::atoi(arguments[2]) : 5;
  Source source(path.string(), read_file(path));
  Diagnostics diagnostics;
  auto const file = load(source, diagnostics);
  if (!file) {
    std::fputs(render(diagnostics, source).c_str(), stderr);
    return 65;
  }
  auto const task = std::find_if(file->tasks.begin(), file->tasks.end(),
                                 [](Task const& each) { return std::holds_alternative<FitTask>(each.what); });
  if (task == file->tasks.end()) return 65;
  auto const target = target_of(*file, std::get<FitTask>(task->what), path.parent_path());
  SilentProgress progress;
  Ledger ledger;
  RunContext context{.seed = 1, .progress = progress, .ledger = ledger};
  SearchResult const found = search(*target, ObjectiveKind::posterior, context);
  char const* const names[] = {"mh", "nuts"};
  Measured measured[std::size(names)];
  for (int round = 0; round < rounds; ++round)
    for (std::size_t s = 0; s < std::size(names); ++s)
      measure(*target, found, *find_backend(names[s]), static_cast<std::uint64_t>(round) + 1, measured[s]);
  for (std::size_t s = 0; s < std::size(names); ++s) {
    std::vector<double> rates;
    for (std::size_t i = 0; i < measured[s].draws.size(); ++i) rates.push_back(measured[s].draws[i] / measured[s].seconds[i]);
    std::printf("%-6s %9.0f effective draws, %7.3f s, %10.0f simulations, %9.0f effective draws per second\n", names[s],
                processor_time::median(measured[s].draws), processor_time::median(measured[s].seconds),
                processor_time::median(measured[s].simulations), processor_time::median(rates));
  }
  return 0;
}
