// `predict` with Gaussian processes: of each draw the functions that its samples leave possible, along other records.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/bands.hpp"
#include "app/coverage.hpp"
#include "app/fit_target.hpp"
#include "app/process_draws.hpp"
#include "app/process_fit.hpp"
#include "app/reporting.hpp"
#include "app/resolved.hpp"
#include "app/solver_record.hpp"
#include "app/stored_draws.hpp"
#include "report/result.hpp"
#include "report/terminal.hpp"

namespace sysid {
namespace {

class ProcessPredict {
 public:
  ProcessPredict(Session& session, Task const& task, PredictTask const& what)
      : session_(session),
        task_(task),
        what_(what),
        fitted_(fitted_model(session, what.fit)),
        fit_task_(session.file.tasks[static_cast<std::size_t>(what.fit)]),
        fit_(std::get<FitTask>(fit_task_.what)),
        trained_(process_target(fit_, process_model(session, fit_, fit_.prediction),
                                load(fit_.experiments, fit_.start, fit_.prediction), fitted_.solver, session.options.execution)),
        model_(process_model(session, fit_, what.prediction)),
        all_(parameter_space(model_->model(), fit_.experiments)),
        data_(load(what.experiments, what.start, what.prediction)),
        seed_(session.seed(task, what.seed)) {}

  ExitCode run() {
    Model const& model = model_->model();
    Report report = begin_report(
        session_, task_, fit_.model,
        fmt::format(
            "predict {} on {} with draws({}){}", fit_task_.name, data_names(session_.file, what_.experiments), what_.draws,
            model.dynamics == Dynamics::discrete ? fmt::format(" ({})", prediction_text(model, what_.prediction)) : std::string()),
        seed_);
    if (fitted_.draws.total() == 1)
      report.findings.push_back(
          {Severity::note, "optimum_alone",
           fmt::format("`{}` is an optimum, not a posterior: the bands hold what the process leaves open, not "
                       "how well its hyper-parameters are known",
                       fit_task_.name),
           "fit with mh for bands that hold both"});
    for (int e = 0; e < static_cast<int>(data_.size()); ++e) predict(e, report);
    report.settings = {{"draws", static_cast<std::int64_t>(what_.draws)}, {"start", start_text(what_.start)}};
    if (model.integrated()) add_solver(fitted_.solver, report.settings);
    if (model.dynamics == Dynamics::discrete) report.settings.emplace_back("prediction", prediction_text(model, what_.prediction));
    bool const missed = add_coverage(report, feeds_back(model));
    report.verdict = grade(report) == Severity::error ? "do not use these bands: too many trajectories are left out"
                     : missed                         ? "the data lie outside their bands more often than they should"
                                                      : "all trajectories stay finite";
    write_result(report, session_.result_folder(task_), session_.options.pictures());
    session_.out << terminal_summary(report);
    return grade(report) == Severity::error ? ExitCode::doubtful : ExitCode::success;
  }

 private:
  std::vector<ExperimentData> load(std::vector<ExperimentUse> const& uses, StartRule start, PredictionRule rule) const {
    return load_experiments(session_, uses, session_.file.models[static_cast<std::size_t>(fit_.model)], start, rule);
  }

  void predict(int e, Report& report) const {
    ExperimentData const& data = data_[static_cast<std::size_t>(e)];
    report.data.push_back(describe_data(session_.file, data, model_->model()));
    ProcessForecast const forecast(trained_, model_, data.experiment, fitted_.solver, start_rows(what_.start),
                                   session_.options.execution);
    LaneArray const columns = spread(fitted_.draws, std::min<int>(what_.draws, static_cast<int>(fitted_.draws.total())));
    int const fitted = what_.fitted[static_cast<std::size_t>(e)];
    LaneArray own(static_cast<int>(model_->model().parameters.size()), columns.width());
    if (fitted >= 0)
      all_->select(all_->values_of_declared(columns), fitted, own);
    else
      own = all_->of_new_experiment(columns, data.use.constants,
                                    {seed_, Purpose::population, static_cast<std::uint64_t>(e) << 32, 0});
    Trajectory::Result const result = forecast_draws(forecast, *all_, columns, own, what_.draws, prediction_noise(seed_, e));
    report.predictions.push_back(bands_along(forecast.quantities(), result, data.experiment, model_->model()));
    report.ledger.merge(result.ledger);
    if (result.failed() > 0)
      report.findings.push_back({failure_severity(result.ledger.failed(), result.ledger.solves()), "failed_predictions",
                                 fmt::format("{} of {} trajectories{} are left out of the bands", result.failed(),
                                             result.ledger.solves(), data_.size() > 1 ? " on " + data.experiment.name : ""),
                                 "the free run leaves the range of numbers, or the covariance cannot be decomposed"});
    say_reach(forecast, columns, own, data.experiment.name, report);
  }

  // Outside the inputs that were fitted a process says what its mean and kernel say, not what was measured.
  void say_reach(ProcessForecast const& forecast, LaneArray const& columns, LaneArray const& own, std::string const& experiment,
                 Report& report) const {
    std::vector<double> declared;
    for (int p = 0; p < columns.rows(); ++p) declared.push_back(columns(p, 0));
    for (auto const& each : forecast.reach(fitted_parameters(*all_, declared), own.view().columns(0, 1)))
      report.findings.push_back({Severity::warning, "far_outside",
                                 fmt::format("`{}` of `{}` lies up to {:.2g} times the width of its fitted range outside it{}",
                                             each.input, each.process, each.widths, data_.size() > 1 ? " on " + experiment : ""),
                                 "there the process returns to the white part, and its band tells the kernel's prior, not data"});
  }

  Session& session_;
  Task const& task_;
  PredictTask const& what_;
  FittedModel const& fitted_;
  Task const& fit_task_;
  FitTask const& fit_;
  std::shared_ptr<ProcessTarget const> trained_;
  std::shared_ptr<ProcessModel const> model_;
  std::shared_ptr<ParameterSpace const> all_;
  std::vector<ExperimentData> data_;
  std::uint64_t seed_;
};

}  // namespace

ExitCode run_process_predict(Session& session, Task const& task, PredictTask const& what) {
  return ProcessPredict(session, task, what).run();
}

}  // namespace sysid
