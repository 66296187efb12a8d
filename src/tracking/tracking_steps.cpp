// Simulations along the first rows.
#include "tracking/tracking_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/text/diagnostic.hpp"
#include "tracking/tracked_rows.hpp"

namespace sysid {

StatePrior states_along(TrackedProgram const& program, SolverSettings const& solver, ExecutionOptions const& execution,
                        Experiment const& experiment, StatePrior const& first, TrackedPrior const& parameters, bool corrects) {
  TrackedPrior known = parameters;
  known.covariance.setZero();
  Experiment along = experiment;
  if (!corrects) std::fill(along.scored.begin(), along.scored.end(), std::uint8_t{0});
  LaneArray records;
  int const rows = static_cast<int>(along.time.size()), n = program.states;
  StatePrior prior{Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, n), true};
  if (!records_along(program, solver, execution, along, parameters_of(program, {}, moments_of(program, first, known)), records))
    throw diverged(experiment, experiment.first_row);
  Eigen::MatrixXd path(n, rows);
  for (int i = 0; i < rows; ++i)
    for (int s = 0; s < n; ++s) path(s, i) = records(i * program.records + program.after + s, 0);
  prior.mean = path.rowwise().mean();
  path.colwise() -= prior.mean;
  prior.covariance = 4 * path * path.transpose() / rows;
  return prior;
}

SolverSettings steps_for_tracking(SolverSettings const& solver) {
  SolverRow const& row = solver.row();
  if (solver.fixed_step() && !row.exact && row.in_program) return solver;
  SolverSettings fixed;
  fixed.method = "rk4";
  return fixed;
}

SolverSettings tracking_solver(TrackedProgram const& program, SolverSettings solver, ExecutionOptions const& execution,
                               Experiment const& experiment, StatePrior const& first, TrackedPrior const& parameters) {
  if (program.program->source.map || solver.as_model) return solver;
  constexpr int rows_compared = 400;
  int const most_substeps = std::max(64, 2 * solver.substeps);  // those of the fit are compared once, however many
  Experiment const part = slice(experiment, 0, std::min<int>(rows_compared, static_cast<int>(experiment.time.size())), 0);
  LaneArray const start = parameters_of(program, {}, moments_of(program, first, parameters));
  LaneArray coarse, fine;
  bool solved = records_along(program, solver, execution, part, start, coarse);
  for (; solver.substeps < most_substeps; solver.substeps *= 2) {
    SolverSettings finer = solver;
    finer.substeps *= 2;
    bool const now = records_along(program, finer, execution, part, start, fine);
    bool agree = solved && now;
    for (int i = 0; agree && i < static_cast<int>(part.time.size()); ++i)
      for (auto const& channel : program.channels) {
        int const row = i * program.records;
        if (std::isnan(fine(row + channel.innovation, 0))) continue;
        double const apart = std::fabs(coarse(row + channel.innovation, 0) - fine(row + channel.innovation, 0));
        agree = agree && apart < 0.01 * std::sqrt(fine(row + channel.variance, 0));
      }
    if (agree) return solver;
    std::swap(coarse, fine);
    solved = now;
  }
  throw UserError(
      {Severity::error,
       "",
       fmt::format("{} steps of {} between two samples are not enough for tracking", most_substeps, solver.method),
       std::nullopt,
       {},
       "the equations are too stiff for the sampling interval: remove the fast dynamics from the model, or sample faster"});
}

}  // namespace sysid
