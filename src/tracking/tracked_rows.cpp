// One simulation of one lane.
#include "tracking/tracked_rows.hpp"

#include <fmt/format.h>

#include "core/text/diagnostic.hpp"

namespace sysid {
namespace {

/// With a column for every channel: an experiment may lack those that come last.
Schedule schedule_of(TrackedProgram const& program, Experiment experiment, SolverSettings const& solver) {
  experiment.measured.resize(program.channels.size());
  if (program.program->source.map) return {*program.program, experiment, SolverSettings{}};
  return {*program.program, experiment, solver};
}

}  // namespace

std::vector<double> moments_of(TrackedProgram const& program, StatePrior const& states, TrackedPrior const& parameters) {
  std::vector<double> moments(static_cast<std::size_t>(program.moments));
  for (int i = 0; i < program.size(); ++i) {
    bool const state = i < program.states;
    moments[static_cast<std::size_t>(i)] = state ? states.mean(i) : parameters.mean(i - program.states);
    for (int j = 0; j <= i; ++j)
      if (int const place = program.place(i, j); place >= 0 && state == (j < program.states))
        moments[static_cast<std::size_t>(place)] =
            state ? states.covariance(i, j) : parameters.covariance(i - program.states, j - program.states);
  }
  return moments;
}

LaneArray parameters_of(TrackedProgram const& program, std::span<double const> intensities, std::span<double const> moments,
                        std::span<double const> factors) {
  int const channels = static_cast<int>(program.channels.size()), before = program.tracked + channels;
  LaneArray all(before + program.moments, 1);
  for (int j = 0; j < program.tracked; ++j) all(j, 0) = intensities.empty() ? 0 : intensities[static_cast<std::size_t>(j)];
  for (int c = 0; c < channels; ++c) all(program.tracked + c, 0) = factors.empty() ? 1 : factors[static_cast<std::size_t>(c)];
  for (int m = 0; m < program.moments; ++m) all(before + m, 0) = moments[static_cast<std::size_t>(m)];
  return all;
}

bool records_along(TrackedProgram const& program, SolverSettings const& solver, ExecutionOptions const& execution,
                   Experiment const& experiment, LaneArray const& parameters, LaneArray& records) {
  int const rows = static_cast<int>(experiment.time.size());
  Simulator const simulator(program.program, schedule_of(program, experiment, solver), execution);
  records = LaneArray(rows * program.records, 1);
  Outcome outcome;
  simulator.records(parameters, 0, rows, records, {&outcome, 1});
  return outcome.ok;
}

UserError diverged(Experiment const& experiment, std::int64_t row) {
  return UserError({Severity::error,
                    "",
                    fmt::format("the filter has no finite values at row {} of {}", row, experiment.name),
                    std::nullopt,
                    {},
                    "the model diverges on these rows: check the record there, or fit the model again"});
}

}  // namespace sysid
