// Gaussian processes: the likelihood with its gradient, and whole optimisations, by either route. Processor seconds.
#include <benchmark/benchmark.h>

#include "gaussian_process/dense.hpp"
#include "gaussian_process/fit.hpp"
#include "gaussian_process/made.hpp"
#include "gaussian_process/state_space.hpp"

namespace {

using namespace sysid;
using namespace sysid::gaussian_process;

Observations record(Eigen::Index count, Eigen::Index inputs, double width) {
  Observations o;
  o.inputs = made_inputs(count, inputs, width);
  o.values = made_values(o.inputs, 0.1);
  return o;
}

void optimise(benchmark::State& state, Likelihood const& likelihood, int parameters, Eigen::Index count) {
  std::vector<Range> const ranges(static_cast<std::size_t>(parameters), {"parameter", 1e-4, 1e4, 1});
  int evaluations = 0;
  for (auto _ : state) {
    Fit const found = fit(likelihood, {}, ranges, count, {.starts = 1});
    evaluations = found.optima.front().evaluations;
    benchmark::DoNotOptimize(evaluations);
  }
  state.counters["evaluations"] = evaluations;
}

void dense_gradient(benchmark::State& state) {
  Observations const o = record(state.range(0), 2, 10);
  Covariance const covariance(*find_kernel("squared_exponential"), {0, 1});
  std::vector<double> const parameters = {1, 1.5, 1.5, 0.1};
  for (auto _ : state) benchmark::DoNotOptimize(dense_marginal(covariance, o, parameters, true).log_likelihood);
}
BENCHMARK(dense_gradient)->Arg(400)->Arg(1600)->Arg(5000)->Unit(benchmark::kMillisecond);

void dense_optimisation(benchmark::State& state) {
  Observations const o = record(state.range(0), 2, 10);
  Covariance const covariance(*find_kernel("squared_exponential"), {0, 1});
  optimise(
      state, [&](Numbers p, bool gradient) { return dense_marginal(covariance, o, p, gradient); }, 4, state.range(0));
}
BENCHMARK(dense_optimisation)->Arg(400)->Arg(1600)->Unit(benchmark::kMillisecond);

void filter_gradient(benchmark::State& state) {
  Observations const o = record(state.range(0), 1, 0.1 * static_cast<double>(state.range(0)));
  Covariance const covariance(*find_kernel("matern52"), {0});
  std::vector<double> const parameters = {1, 1.5, 0.1};
  for (auto _ : state) benchmark::DoNotOptimize(state_space_marginal(covariance, o, parameters, true).log_likelihood);
}
BENCHMARK(filter_gradient)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond);

void filter_optimisation(benchmark::State& state) {
  Observations const o = record(state.range(0), 1, 0.1 * static_cast<double>(state.range(0)));
  Covariance const covariance(*find_kernel("matern52"), {0});
  optimise(
      state, [&](Numbers p, bool gradient) { return state_space_marginal(covariance, o, p, gradient); }, 3, state.range(0));
}
BENCHMARK(filter_optimisation)->Arg(100000)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
