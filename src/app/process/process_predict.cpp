// `predict` with Gaussian processes: of each draw the functions that its samples leave possible, along other records.
#include <fmt/format.h>

#include <cmath>

#include "app/process/process_draws.hpp"
#include "app/process/process_scores.hpp"
#include "app/process/process_trajectories.hpp"
#include "app/session/made_from.hpp"
#include "app/session/provenance.hpp"
#include "app/session/reporting.hpp"
#include "app/session/resolved.hpp"
#include "app/session/solver_record.hpp"
#include "data/start_rule.hpp"
#include "diagnostics/bands.hpp"
#include "diagnostics/coverage.hpp"
#include "diagnostics/verdict.hpp"
#include "experiment/fitted_rows.hpp"

namespace sysid {
namespace {

class ProcessPredict {
 public:
  ProcessPredict(Session& session, Task const& task, PredictTask const& what)
      : session_(session),
        task_(task),
        what_(what),
        fit_task_(session.file.tasks[static_cast<std::size_t>(what.fit)]),
        seed_(session.seed(task, what.seed)),
        trajectories_(session, what, seed_) {}

  ExitCode run() {
    Model const& model = trajectories_.model();
    Report report = begin_report(
        session_, task_, std::get<FitTask>(fit_task_.what).model,
        fmt::format(
            "predict {} on {} with draws({}){}", fit_task_.name, data_names(session_.file, what_.experiments), what_.draws,
            model.dynamics == Dynamics::discrete ? fmt::format(" ({})", prediction_text(model, what_.prediction)) : std::string()),
        seed_);
    add_prediction_rule(model, what_.prediction, report);
    if (trajectories_.fitted().draws.is_optimum())
      report.findings.push_back({FindingCode::optimum_alone,
                                 Severity::note,
                                 {fit_task_.name},
                                 fmt::format("`{}` gives an optimum, not a posterior: the bands include the uncertainty of the "
                                             "process, but not of its hyper-parameters",
                                             fit_task_.name),
                                 "fit with mh for bands that include both"});
    for (int e = 0; e < static_cast<int>(trajectories_.data().size()); ++e) predict(e, report);
    add_source(session_.result_folder(fit_task_), report);
    report.settings = {{"draws", static_cast<std::int64_t>(what_.draws)}, {"start", start_text(what_.start)}};
    if (model.integrated()) add_solver(trajectories_.fitted().solver, report.settings);
    if (model.dynamics == Dynamics::discrete) report.settings.emplace_back("prediction", prediction_text(model, what_.prediction));
    bool const missed = add_coverage(report, feeds_back(model));
    report.verdict = prediction_verdict(report, missed);
    keep_result(session_, task_, report);
    return grade(report) == Severity::error ? ExitCode::doubtful : ExitCode::success;
  }

 private:
  void predict(int e, Report& report) const {
    ExperimentData const& data = trajectories_.data()[static_cast<std::size_t>(e)];
    bool const several = trajectories_.data().size() > 1;
    add_data(session_.file, data, trajectories_.model(), report);
    for (Finding& finding :
         find_fitted_rows(session_.file, session_.folder(), data, std::get<FitTask>(fit_task_.what).experiments, fit_task_.name))
      report.findings.push_back(std::move(finding));
    ProcessForecast const forecast = trajectories_.forecast(e);
    LaneArray const own = trajectories_.parameters(e);
    Trajectory::Result const result = trajectories_.run(e, forecast, own);
    report.predictions.push_back(bands_along(forecast.quantities(), result, data.experiment, trajectories_.model()));
    report.ledger.merge(result.ledger);
    if (result.failed() > 0)
      report.findings.push_back({FindingCode::failed_predictions,
                                 failure_severity(result.ledger.failed(), result.ledger.solves()),
                                 {data.experiment.name},
                                 fmt::format("{} of {} trajectories{} are left out of the bands", result.failed(),
                                             result.ledger.solves(), several ? " on " + data.experiment.name : ""),
                                 "the free run overflows, or the covariance cannot be decomposed"});
    for (Finding& finding : channel_band_findings(report.predictions.back(), trajectories_.model(), result.failed(), several))
      report.findings.push_back(std::move(finding));
    say_reach(forecast, own, several ? " on " + data.experiment.name : "", report);
  }

  // Outside the inputs that were fitted a process says what its mean and kernel say, not what was measured.
  void say_reach(ProcessForecast const& forecast, LaneArray const& own, std::string const& where, Report& report) const {
    LaneArray const draws = trajectories_.draws();
    std::vector<double> declared;
    for (int p = 0; p < draws.rows(); ++p) declared.push_back(draws(p, 0));
    for (auto const& each : forecast.reach(fitted_parameters(trajectories_.space(), declared), own.view().columns(0, 1)))
      report.findings.push_back(
          {FindingCode::far_outside,
           Severity::warning,
           {each.process, each.input},
           std::isfinite(each.widths)
               ? fmt::format("the input `{}` of `{}` lies outside its fitted range by up to {:.2g} times the width of that range{}",
                             each.input, each.process, each.widths, where)
               : fmt::format("the input `{}` of `{}` differs from the one value that it had at all fitted samples{}", each.input,
                             each.process, where),
           "do not rely on the band there: the process returns to zero, and its band follows from its prior, not from "
           "data"});
  }

  Session& session_;
  Task const& task_;
  PredictTask const& what_;
  Task const& fit_task_;
  std::uint64_t seed_;
  ProcessTrajectories trajectories_;
};

}  // namespace

ExitCode run_process_predict(Session& session, Task const& task, PredictTask const& what) {
  return ProcessPredict(session, task, what).run();
}

}  // namespace sysid
