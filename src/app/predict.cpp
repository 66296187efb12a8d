// `predict`: trajectories of posterior draws along a record, condensed to bands with and without noise, and scored on its rows.
#include <fmt/format.h>

#include <algorithm>

#include "app/bands.hpp"
#include "app/experiments.hpp"
#include "app/reporting.hpp"
#include "app/solver_record.hpp"
#include "app/stored_draws.hpp"
#include "likelihood/trajectory.hpp"
#include "report/result.hpp"
#include "report/terminal.hpp"

namespace sysid {
ExitCode run_predict(Session& session, Task const& task, PredictTask const& what) {
  FittedModel const& fitted = fitted_model(session, what.fit);
  FitTask const& fit = std::get<FitTask>(session.file.tasks[static_cast<std::size_t>(what.fit)].what);
  bool const free_start = what.start.kind == StartRule::Kind::estimated;
  auto const compiled = session.compiled(fit.model, free_start, fitted.solver.method);
  Model const& model = compiled->model;
  DataBlock const& block = session.file.data[static_cast<std::size_t>(what.data)];
  Record const record = load_record(block, model, session.folder());
  Experiment const experiment = cut(record, block, what.part, what.start);
  std::uint64_t const seed = session.seed(task, what.seed);

  Trajectory const trajectory(compiled, experiment, fitted.solver, free_start ? what.start.rows : 0, session.options.execution);
  StreamKey const noise_key{seed, Purpose::noise, 0, 0};
  int const wanted = std::min<int>(what.draws, static_cast<int>(fitted.draws.total()));
  LaneArray const columns = spread(fitted.draws, what.redraw_each_step ? static_cast<int>(fitted.draws.total()) : wanted);
  Trajectory::Result const result = what.redraw_each_step
                                        ? trajectory.run_redrawn(columns, wanted, {seed, Purpose::redraw, 0, 0}, noise_key)
                                        : trajectory.run(columns, noise_key);

  Report report = begin_report(session, task, fit.model,
                               fmt::format("predict {} on {} with draws({})",
                                           session.file.tasks[static_cast<std::size_t>(what.fit)].name, experiment.name, wanted),
                               seed);
  report.data.push_back(describe_data(record, block, what.part, model, experiment));
  report.predictions.push_back(bands_along(trajectory, result, experiment, model));
  for (PredictedQuantity const& quantity : report.predictions.front().quantities)
    for (Score score : scores(quantity, experiment.scored)) {
      if (model.channels.size() > 1) score.name += "(" + quantity.name + ")";
      report.fit.push_back(std::move(score));
    }
  report.settings = {{"draws", static_cast<std::int64_t>(wanted)},
                     {"redraw", std::string(what.redraw_each_step ? "step" : "trajectory")},
                     {"start", std::string(free_start ? fmt::format("estimated(rows = {})", what.start.rows)
                                           : what.start.kind == StartRule::Kind::rest ? "rest"
                                                                                      : "record")}};
  add_solver(fitted.solver, report.settings);
  report.ledger.add_solves(static_cast<std::uint64_t>(wanted));
  if (result.failed > 0) {
    report.findings.push_back(
        {result.failed == wanted ? Severity::error : Severity::warning, "failed_predictions",
         fmt::format("{} of {} trajectories do not stay finite and are left out of the bands", result.failed, wanted),
         "the posterior reaches where the model diverges on this input"});
  }
  report.verdict = result.failed == 0 ? "all trajectories stay finite" : "some trajectories do not stay finite";
  write_result(report, session.result_folder(task), session.options.figures);
  session.out << terminal_summary(report);
  return grade(report) == Severity::error ? ExitCode::doubtful : ExitCode::success;
}

}  // namespace sysid
