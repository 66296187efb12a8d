// `predict`: trajectories of posterior draws along records, condensed to bands with and without noise, and scored on their rows.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/bands.hpp"
#include "app/coverage.hpp"
#include "app/drift.hpp"
#include "app/experiments.hpp"
#include "app/function_ranges.hpp"
#include "app/process_fit.hpp"
#include "app/reporting.hpp"
#include "app/resolved.hpp"
#include "app/restoring_force.hpp"
#include "app/solver_record.hpp"
#include "app/stored_draws.hpp"
#include "likelihood/trajectory.hpp"
#include "report/result.hpp"
#include "report/terminal.hpp"

namespace sysid {
namespace {

// The per-experiment parameters that a new experiment draws from their prior, by name.
std::vector<std::string> drawn_parameters(Model const& model, ExperimentUse const& use) {
  std::vector<std::string> names;
  for (std::size_t p = 0; p < model.parameters.size(); ++p)
    if (model.parameters[p].per_experiment && model.parameters[p].prior && !use.constants[p])
      names.push_back("`" + model.parameters[p].name + "`");
  return names;
}

class Predict {
 public:
  Predict(Session& session, Task const& task, PredictTask const& what)
      : session_(session),
        task_(task),
        what_(what),
        fitted_(fitted_model(session, what.fit)),
        fit_task_(session.file.tasks[static_cast<std::size_t>(what.fit)]),
        fit_(std::get<FitTask>(fit_task_.what)),
        free_start_(what.start.kind == StartRule::Kind::estimated),
        compiled_(session.compiled(fit_.model, free_start_, fitted_.solver.method, what.prediction)),
        model_(compiled_->model),
        space_(parameter_space(model_, fit_.experiments)),
        data_(load_experiments(session, what.experiments, session.file.models[static_cast<std::size_t>(fit_.model)], what.start,
                               what.prediction)),
        seed_(session.seed(task, what.seed)),
        wanted_(std::min<int>(what.draws, static_cast<int>(fitted_.draws.total()))) {}

  ExitCode run() {
    Report report = begin_report(
        session_, task_, fit_.model,
        fmt::format("predict {} on {} with draws({}){}", fit_task_.name, data_names(session_.file, what_.experiments), wanted_,
                    model_.dynamics == Dynamics::discrete ? fmt::format(" ({})", prediction_text(model_, what_.prediction))
                                                          : std::string()),
        seed_);
    if (fitted_.draws.total() == 1)
      report.findings.push_back(
          {Severity::note, "optimum_alone",
           fmt::format("`{}` is an optimum, not a posterior: the bands leave out how well parameters are known", fit_task_.name),
           "fit with mh for bands that hold it"});
    for (int e = 0; e < static_cast<int>(data_.size()); ++e) {
      report.data.push_back(describe_data(session_.file, data_[static_cast<std::size_t>(e)], model_));
      predict(e, report);
    }
    report.settings = {{"draws", static_cast<std::int64_t>(wanted_)},
                       {"redraw", std::string(what_.redraw_each_step ? "step" : "trajectory")},
                       {"start", start_text(what_.start)}};
    if (model_.integrated()) add_solver(fitted_.solver, report.settings);
    if (model_.dynamics == Dynamics::discrete)
      report.settings.emplace_back("prediction", prediction_text(model_, what_.prediction));
    bool const missed = add_coverage(report, model_.dynamics == Dynamics::discrete && !model_.states.empty());
    report.verdict = grade(report) == Severity::error ? "do not use these bands: too many trajectories are left out"
                     : report.ledger.failed() > 0     ? "some trajectories do not stay finite"
                     : missed                         ? "all trajectories stay finite, but the data lie outside their bands"
                                                      : "all trajectories stay finite";
    write_result(report, session_.result_folder(task_), session_.options.pictures());
    session_.out << terminal_summary(report);
    return grade(report) == Severity::error ? ExitCode::doubtful : ExitCode::success;
  }

 private:
  // Parameters of the model in experiment e for each draw, SI.
  LaneArray parameters(int e, LaneArray const& declared, Report& report) const {
    ExperimentUse const& use = data_[static_cast<std::size_t>(e)].use;
    int const fitted = what_.fitted[static_cast<std::size_t>(e)];
    if (fitted >= 0) {
      LaneArray own(static_cast<int>(model_.parameters.size()), declared.width());
      space_->select(space_->values_of_declared(declared), fitted, own);
      return own;
    }
    if (auto const drawn = drawn_parameters(model_, use); !drawn.empty())
      report.findings.push_back({Severity::note, "new_experiment",
                                 fmt::format("`{}` was not fitted: {} {} drawn from the prior given the shared parameters",
                                             use.name, fmt::join(drawn, ", "), drawn.size() == 1 ? "is" : "are"),
                                 ""});
    return space_->of_new_experiment(declared, use.constants, {seed_, Purpose::population, static_cast<std::uint64_t>(e) << 32, 0});
  }

  // Adds bands, findings and failures of experiment e.
  void predict(int e, Report& report) const {
    Experiment const& experiment = data_[static_cast<std::size_t>(e)].experiment;
    Trajectory const trajectory(compiled_, experiment, fitted_.solver, free_start_ ? what_.start.rows : 0,
                                session_.options.execution,
                                [this](NodeId node, Graph const& graph) { return session_.describe(fit_.model, graph, node); });
    StreamKey const noise = prediction_noise(seed_, e);
    LaneArray const draws =
        parameters(e, spread(fitted_.draws, what_.redraw_each_step ? static_cast<int>(fitted_.draws.total()) : wanted_), report);
    Trajectory::Result const result = what_.redraw_each_step
                                          ? trajectory.run_redrawn(draws, wanted_, {seed_, Purpose::redraw, noise.index, 0}, noise)
                                          : trajectory.run(draws, noise);
    report.predictions.push_back(bands_along(trajectory.quantities(), result, experiment, model_));
    for (Finding& finding :
         check_ranges(model_, experiment, fitted_.solver, free_start_ ? what_.start.rows : 0, draws, session_.options.execution))
      report.findings.push_back(std::move(finding));
    // Parameters that change from step to step have no force of their own.
    if (!what_.redraw_each_step)
      for (RestoringForce& force : restoring_forces(model_, trajectory.quantities(), result, draws, experiment))
        report.forces.push_back(std::move(force));
    for (Finding& finding : drift_findings(session_, model_, result, experiment.name))
      report.findings.push_back(std::move(finding));
    report.ledger.merge(result.ledger);
    Severity const severity = failure_severity(result.ledger.failed(), result.ledger.solves());
    if (result.failed() > 0)
      report.findings.push_back({severity, "failed_predictions",
                                 fmt::format("{} of {} trajectories{} do not stay finite and are left out of the bands",
                                             result.failed(), wanted_, data_.size() > 1 ? " on " + experiment.name : ""),
                                 "the posterior reaches where the model diverges on this input"});
    for (Finding& finding : band_findings(report.predictions.back(), result.failed(), result.failed(), data_.size() > 1))
      report.findings.push_back(std::move(finding));
  }

  Session& session_;
  Task const& task_;
  PredictTask const& what_;
  FittedModel const& fitted_;
  Task const& fit_task_;
  FitTask const& fit_;
  bool free_start_;
  std::shared_ptr<CompiledModel const> compiled_;
  Model const& model_;
  std::shared_ptr<ParameterSpace const> space_;
  std::vector<ExperimentData> data_;
  std::uint64_t seed_;
  int wanted_;
};

}  // namespace

ExitCode run_predict(Session& session, Task const& task, PredictTask const& what) {
  auto const& fit = std::get<FitTask>(session.file.tasks[static_cast<std::size_t>(what.fit)].what);
  if (!session.file.models[static_cast<std::size_t>(fit.model)].processes.empty()) return run_process_predict(session, task, what);
  return Predict(session, task, what).run();
}

}  // namespace sysid
