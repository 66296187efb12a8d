// `predict`: simulates trajectories of posterior draws, computes bands with and without noise, and scores them.
#include "app/task/tasks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/process/process_fit.hpp"
#include "app/session/made_from.hpp"
#include "app/session/posterior_trajectories.hpp"
#include "app/session/provenance.hpp"
#include "app/session/reporting.hpp"
#include "app/session/resolved.hpp"
#include "app/session/solver_record.hpp"
#include "core/system/interrupt.hpp"
#include "data/start_rule.hpp"
#include "diagnostics/bands.hpp"
#include "diagnostics/coverage.hpp"
#include "diagnostics/drift.hpp"
#include "diagnostics/function_ranges.hpp"
#include "diagnostics/verdict.hpp"
#include "experiment/experiments.hpp"
#include "experiment/fitted_rows.hpp"
#include "mechanics/restoring_force.hpp"

namespace sysid {
namespace {

class Predict {
 public:
  Predict(Session& session, Task const& task, PredictTask const& what)
      : session_(session),
        task_(task),
        what_(what),
        fit_task_(session.file.tasks[static_cast<std::size_t>(what.fit)]),
        fit_(std::get<FitTask>(fit_task_.what)),
        seed_(session.seed(task, what.seed)),
        trajectories_(session, what, seed_),
        model_(trajectories_.model()),
        data_(trajectories_.data()) {}

  ExitCode run() {
    Report report =
        begin_report(session_, task_, fit_.model,
                     fmt::format("predict {} on {} with draws({}){}", fit_task_.name, data_names(session_.file, what_.experiments),
                                 trajectories_.wanted(), predicted_.empty() ? std::string() : fmt::format(" ({})", predicted_)),
                     seed_);
    add_predicted_rule(model_, what_.prediction, report);
    if (what_.ahead > 1) report.prediction_rule = fmt::format("{} steps", what_.ahead);
    if (trajectories_.fitted().draws.is_optimum())
      report.findings.push_back(
          {FindingCode::optimum_alone,
           Severity::note,
           {fit_task_.name},
           fmt::format("`{}` gives an optimum, not a posterior: the bands do not include the uncertainty of the parameters",
                       fit_task_.name),
           "fit with mh for bands that include it"});
    for (int e = 0; e < static_cast<int>(data_.size()); ++e) {
      add_data(session_.file, data_[static_cast<std::size_t>(e)], model_, report);
      predict(e, report);
      for (Finding& finding :
           find_fitted_rows(session_.file, session_.folder(), data_[static_cast<std::size_t>(e)], fit_.experiments, fit_task_.name))
        report.findings.push_back(std::move(finding));
    }
    add_source(session_.result_folder(fit_task_), report);
    report.settings = {{"draws", static_cast<std::int64_t>(trajectories_.wanted())},
                       {"redraw", std::string(what_.redraw_each_step ? "step" : "trajectory")},
                       {"start", start_text(what_.start)}};
    if (model_.integrated()) add_solver(trajectories_.solver(), report.settings);
    if (!predicted_.empty()) report.settings.emplace_back("prediction", predicted_);
    bool const missed = add_coverage(report, model_.dynamics == Dynamics::discrete && !model_.states.empty());
    report.verdict = prediction_verdict(report, missed);
    keep_result(session_, task_, report);
    return grade(report) == Severity::error ? ExitCode::doubtful : ExitCode::success;
  }

 private:
  // Adds bands, findings and failures of experiment e.
  void predict(int e, Report& report) const {
    Experiment const& experiment = data_[static_cast<std::size_t>(e)].experiment;
    if (auto const drawn = trajectories_.drawn_from_prior(e); !drawn.empty())
      report.findings.push_back(
          {FindingCode::new_experiment,
           Severity::note,
           {data_[static_cast<std::size_t>(e)].use.name},
           fmt::format("`{}` was not fitted: {} {} drawn from the prior given the shared parameters",
                       data_[static_cast<std::size_t>(e)].use.name, fmt::join(drawn, ", "), drawn.size() == 1 ? "is" : "are"),
           ""});
    Trajectory const trajectory = trajectories_.trajectory(e);
    LaneArray const draws = trajectories_.parameters(e);
    stop_if_interrupted();
    Trajectory::Result result = trajectories_.run(e, trajectory, draws);
    if (!model_.filtered()) trajectories_.add_noise(e, trajectory, draws, result);  // else the sds of samples tell the band
    stop_if_interrupted();
    report.predictions.push_back(bands_along(trajectory.quantities(), result, experiment, model_));
    for (Finding& finding :
         check_ranges(model_, experiment, trajectories_.solver(), trajectories_.start_rows(), draws, session_.abandonable()))
      report.findings.push_back(std::move(finding));
    if (!model_.expansions.empty())
      for (Finding& finding : check_reach(model_, trajectories_.fitted_runs(), {experiment, trajectories_.start_rows(), draws},
                                          trajectories_.solver(), session_.abandonable()))
        report.findings.push_back(std::move(finding));
    // Parameters that change from step to step have no force of their own.
    if (!what_.redraw_each_step) add_restoring_forces(model_, trajectory.quantities(), result, draws, experiment, report.forces);
    for (Finding& finding : drift_findings(session_.source, model_, result, experiment.name))
      report.findings.push_back(std::move(finding));
    report.ledger.merge(result.ledger);
    Severity const severity = failure_severity(result.ledger.failed(), result.ledger.solves());
    if (result.failed() > 0)
      report.findings.push_back(
          {FindingCode::failed_predictions,
           severity,
           {experiment.name},
           fmt::format("{} of {} trajectories{} do not stay finite and are left out of the bands", result.failed(),
                       trajectories_.wanted(), data_.size() > 1 ? " on " + experiment.name : ""),
           "the model diverges on this input at some draws: narrow the priors, or check the equation"});
    for (Finding& finding : band_findings(report.predictions.back(), result.failed(), result.failed(), data_.size() > 1))
      report.findings.push_back(std::move(finding));
  }

  Session& session_;
  Task const& task_;
  PredictTask const& what_;
  Task const& fit_task_;
  FitTask const& fit_;
  std::uint64_t seed_;
  PosteriorTrajectories trajectories_;
  Model const& model_;
  std::string predicted_ = predicted_text(model_, what_.prediction, what_.ahead);
  std::vector<ExperimentData> const& data_;
};

}  // namespace

ExitCode run_predict(Session& session, Task const& task, PredictTask const& what) {
  auto const& fit = std::get<FitTask>(session.file.tasks[static_cast<std::size_t>(what.fit)].what);
  if (!session.file.models[static_cast<std::size_t>(fit.model)].processes.empty()) return run_process_predict(session, task, what);
  return Predict(session, task, what).run();
}

}  // namespace sysid
