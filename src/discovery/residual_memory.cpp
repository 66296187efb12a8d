// Residuals of the segments in a row, the segments of an experiment one after the other; what is not measured breaks the series.
#include "discovery/residual_memory.hpp"

#include <cmath>

#include "diagnostics/residuals/residual_tests.hpp"

namespace sysid {
namespace {

/// Of the sd of a channel: what is smaller may be the error of the integrator, which is no noise.
constexpr double least_residual = 1e-5;

double size_of(std::vector<double> const& series) {
  double squares = 0, count = 0;
  for (double const each : series)
    if (std::isfinite(each)) squares += each * each, ++count;
  return count > 0 ? std::sqrt(squares / count) : 0;
}

}  // namespace

std::vector<ResidualMemory> residual_memory(ValidatedModel const& model, ShootingFit const& fit,
                                            std::span<Experiment const> experiments, std::vector<Segment> const& segments,
                                            SolverSettings const& solver, NoiseShape const& noise,
                                            ExecutionOptions const& execution, std::shared_ptr<ThreadPool> const& pool) {
  SegmentSimulation const simulation(model.compiled, experiments, segments,
                                     {model.fitted(), model.others, 0, solver, execution, pool, model.centres, noise});
  std::vector<SegmentSlopes> const runs = simulation.residuals(fit.point);
  std::size_t const channels = model.channels.size();
  std::vector<std::vector<double>> series(channels * experiments.size());
  for (std::size_t s = 0; s < segments.size(); ++s) {
    int const rows = simulation.rows_of_channel(static_cast<int>(s));
    for (std::size_t c = 0; c < channels; ++c) {
      std::vector<double>& of = series[static_cast<std::size_t>(segments[s].experiment) * channels + c];
      of.resize(experiments[static_cast<std::size_t>(segments[s].experiment)].time.size(), std::nan(""));
      for (int i = 0; i < rows; ++i) {
        int const place = static_cast<int>(c) * rows + i;
        if (simulation.measured(static_cast<int>(s), place))
          of[static_cast<std::size_t>(segments[s].first + i)] = runs[s].residual(place);
      }
    }
  }
  std::vector<CorrelationTest> tests;
  std::vector<double> p_values;
  for (std::size_t i = 0; i < series.size(); ++i) {
    bool const tested = size_of(series[i]) > least_residual * simulation.size(static_cast<int>(i % channels));
    tests.push_back(tested ? whiteness(series[i]) : CorrelationTest{});
    p_values.push_back(tests.back().tail_p_value);
  }
  double const limit = limit_together(p_values);
  std::vector<ResidualMemory> found;
  for (std::size_t i = 0; i < tests.size(); ++i)
    if (tests[i].fires(limit))
      found.push_back({i % channels, i / channels, tests[i].outside, static_cast<int>(tests[i].correlation.size())});
  return found;
}

}  // namespace sysid
