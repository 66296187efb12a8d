// Equations from records: whole regressions (projection, whitening, choice) of made and recorded systems, and the selectors alone
// on a recorded matrix. What refits by simulation add is in the whole runs of docs/benchmarks.md.
#include <benchmark/benchmark.h>

#include "regression/problems.hpp"

namespace {

using namespace sysid;
using namespace sysid::regression;

std::string const models = SYSID_SOURCE_DIR "/models/discovery/";

void discoveries(benchmark::State& state, Dictionary const& dictionary, Experiment experiment, std::string_view selector) {
  std::vector<Experiment> const experiments = {std::move(experiment)};
  Method const chosen = method(selector);
  for (auto _ : state) benchmark::DoNotOptimize(discover(dictionary, experiments, chosen).equations.size());
}

void duffing(benchmark::State& state, std::string_view selector) {
  discoveries(state, duffing_dictionary(), duffing_record(1, 500, 0.01), selector);
}
BENCHMARK_CAPTURE(duffing, spike_slab, "spike_slab")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(duffing, ard, "ard")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(duffing, threshold, "threshold")->Unit(benchmark::kMillisecond);

void lorenz(benchmark::State& state) {
  discoveries(state, polynomial_dictionary({"x", "y", "z"}, static_cast<int>(state.range(0))), recorded(models + "lorenz_0.csv"),
              "spike_slab");
}
BENCHMARK(lorenz)->ArgName("degree")->Arg(2)->Arg(5)->Unit(benchmark::kMillisecond);

void predator_prey(benchmark::State& state) {
  discoveries(state, polynomial_dictionary({"prey", "predator"}, static_cast<int>(state.range(0))),
              recorded(models + "predator_prey_0.csv"), "spike_slab");
}
BENCHMARK(predator_prey)->ArgName("degree")->Arg(3)->Unit(benchmark::kMillisecond);

/// 40 rows, eight columns of which three are true; see the file.
LinearProblem recorded_matrix() {
  Table const table = Table::read(SYSID_SOURCE_DIR "/tests/regression/fixtures/ard_matrix.csv");
  auto const column = [&](std::string const& name) {
    std::vector<double> const numbers = table.numbers(name);
    return Eigen::VectorXd(Eigen::Map<Eigen::VectorXd const>(numbers.data(), static_cast<Eigen::Index>(numbers.size())));
  };
  constexpr int terms = 8;
  LinearProblem problem{column("b"), {}, std::vector<char>(terms, 0)};
  problem.terms.resize(problem.known.size(), terms);
  for (int j = 0; j < terms; ++j) problem.terms.col(j) = column("a" + std::to_string(j + 1));
  return problem;
}

void selection(benchmark::State& state, std::string_view selector) {
  LinearProblem const problem = recorded_matrix();
  SelectorRow const& row = *find_selector(selector);
  Settings const settings(row.settings);
  for (auto _ : state) benchmark::DoNotOptimize(row.choose(problem, settings, {}).noise_sd);
}
BENCHMARK_CAPTURE(selection, spike_slab, "spike_slab")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(selection, ard, "ard")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(selection, threshold, "threshold")->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
