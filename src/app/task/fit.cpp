// `fit`: data to target, search, step size, sampling with checkpoints, checks, results.
#include "app/task/tasks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/preflight/check_file.hpp"
#include "app/process/process_fit.hpp"
#include "app/session/derived_draws.hpp"
#include "app/session/fit_end.hpp"
#include "app/session/fit_target.hpp"
#include "app/session/preconditions.hpp"
#include "app/session/preparation.hpp"
#include "app/session/provenance.hpp"
#include "app/session/reporting.hpp"
#include "app/session/resolved.hpp"
#include "app/session/search_near.hpp"
#include "app/session/session.hpp"
#include "app/session/solver_record.hpp"
#include "app/session/solver_refinement.hpp"
#include "app/session/task_checkpoint.hpp"
#include "app/session/unknown_functions.hpp"
#include "data/start_rule.hpp"
#include "diagnostics/bands.hpp"
#include "diagnostics/bound_check.hpp"
#include "diagnostics/convergence.hpp"
#include "diagnostics/drift.hpp"
#include "diagnostics/fit_checks.hpp"
#include "diagnostics/function_ranges.hpp"
#include "diagnostics/residual_checks.hpp"
#include "diagnostics/tolerance.hpp"
#include "diagnostics/verdict.hpp"
#include "experiment/experiments.hpp"
#include "inference/backend/checkpoint.hpp"
#include "inference/evidence.hpp"
#include "inference/table.hpp"
#include "likelihood/trajectory.hpp"
#include "mechanics/restoring_force.hpp"
#include "search/search.hpp"

namespace sysid {

namespace {

using json = nlohmann::json;

class Fit {
 public:
  Fit(Session& session, int index, Task const& task, FitTask const& what)
      : session_(session),
        index_(index),
        task_(task),
        what_(what),
        checkpoint_(session, task, what.seed),
        seed_(checkpoint_.seed()),
        backend_(*find_backend(what.backend)),
        compiled_(session.compiled(what.model, what.start.kind == StartRule::Kind::estimated, what.solver.method, what.prediction)),
        model_(compiled_->model),
        space_(parameter_space(model_, what.experiments)),
        data_(load_experiments(session, what.experiments, session.file.models[static_cast<std::size_t>(what.model)], what.start,
                               what.prediction)),
        began_(std::chrono::steady_clock::now()) {
    checkpoint_.of_data(data_);
  }

  ExitCode run() {
    if (auto const why = refusal(task_, what_, model_, data_)) throw UserError(*why);
    RunContext context{seed_,   session_.progress,
                       ledger_, [this] { return session_.interrupted(); },
                       {},      session_.options.checkpoint_interval,
                       {},      {},
                       {}};
    std::shared_ptr<json const> const stored = checkpoint_.stored();
    if (!stored) {
      if (!prepare(context)) return stop_early(session_, task_, checkpoint_);
    } else {
      preparation_ = restore_preparation(stored->at("preparation"));
      if (stored->contains("state")) context.resume = std::make_shared<json const>(stored->at("state"));
      session_.notices << fmt::format("{}: going on from the checkpoint\n", task_.name);
    }
    target_ = make_target(preparation_.solver, session_.options.execution);
    context.modes = preparation_.modes;
    context.mode_findings = preparation_.findings;
    context.checkpoint = [this](json const& state) { checkpoint_.save({{"preparation", store(preparation_)}, {"state", state}}); };
    FitResult result = backend_.run(*target_, what_.settings, context);
    if (result.failure) throw UserError(no_result(task_, *result.failure));
    if (result.interrupted && result.draws.total() == 0) return stop_early(session_, task_, checkpoint_);
    return finish(std::move(result));
  }

 private:
  std::unique_ptr<ModelTarget> make_target(SolverSettings const& solver, ExecutionOptions const& execution) const {
    return make_fit_target(session_, what_, compiled_, space_, experiments_of(data_), solver, execution);
  }

  // Search and, unless the user fixed it, the step. False: interrupted.
  bool prepare(RunContext& context) {
    MakeTarget const make = [this](SolverSettings const& solver) { return make_target(solver, session_.interruptible()); };
    preparation_.solver = what_.solver;
    Findings const size = check_prior_size(session_, what_, data_);
    tell_of_data(session_, task_, data_, model_);
    tell(session_, task_, size);
    if (what_.settle && model_.integrated()) {
      SearchSolver const search = search_solver(make, what_.solver, seed_);
      if (context.stop_requested()) return false;
      if (search.solver != what_.solver)
        session_.notices << fmt::format("{}: searching with {}: with {}, {:.0f} % of the prior draws leave the range of numbers\n",
                                        task_.name, accuracy(search.solver), accuracy(what_.solver), 100 * search.failed_as_given);
      preparation_.solver = search.solver;
    }
    auto const target = make(preparation_.solver);
    RunContext search_context{
        seed_, session_.progress, preparation_.ledger, context.interrupted, {}, context.checkpoint_interval, {}, {}, {}};
    SearchResult found = what_.near ? search_near(session_, *what_.near, *target, backend_.aim, search_context)
                                    : search(*target, backend_.aim, search_context);
    if (found.interrupted) return false;
    if (found.failure) {
      ledger_.merge(preparation_.ledger);
      throw UserError(no_result(task_, *found.failure));
    }
    preparation_.modes = std::move(found.modes);
    preparation_.findings = std::move(found.findings);
    preparation_.findings.insert(preparation_.findings.end(), size.begin(), size.end());
    tell(session_, task_, ranges_at(preparation_.modes.front().declared));
    return !what_.settle || settle(session_, task_, make, backend_.aim, what_.solver, preparation_, search_context);
  }

  // --- the end
  // --------------------------------------------------------------------------------------------------------------------
  ExitCode finish(FitResult result) {
    bool const interrupted = result.interrupted;
    Report report = begin_report(
        session_, task_, what_.model,
        fmt::format("fit {} to {} with {}", model_.name, data_names(session_.file, what_.experiments), what_.backend), seed_);
    report.priors = priors_of(*space_, report.priors);
    // What is wrong with the record comes before what follows from it.
    for (ExperimentData const& each : data_) add_data(session_.file, each, model_, report);
    report.findings.insert(report.findings.end(), result.findings.begin(), result.findings.end());
    if (!result.search_told)
      report.findings.insert(report.findings.end(), preparation_.findings.begin(), preparation_.findings.end());
    auto const add = [&](Findings const& more) { report.findings.insert(report.findings.end(), more.begin(), more.end()); };
    report.summary = summarise(result);
    for (std::size_t p = 0; p < report.summary.size(); ++p) report.summary[p].coefficient = target_->parameters()[p].coefficient;
    add(check_use(model_, what_.start));
    Ledger extra;
    std::vector<double> const best = result.modes.empty() ? best_draw(result.draws) : result.modes.front().declared;
    if (!interrupted) {
      target_ = make_target(preparation_.solver, session_.interruptible());  // sampling must not be given up on the way, this may
      FitCheck check = check_residuals(*target_, best);
      report.fit = std::move(check.lines);
      add(check.findings);
      bool const explains = std::none_of(check.findings.begin(), check.findings.end(), [](Finding const& each) {
        return each.code == FindingCode::worse_than_the_mean || each.code == FindingCode::explains_little;
      });
      if (explains && !preparation_.modes.empty() && model_.dynamics == Dynamics::continuous)
        add(check_input_timing(*target_, backend_.aim, preparation_.modes.front(), seed_, extra));
      if (model_.integrated()) add(step_check(result.draws, extra));
    }
    if (!interrupted && !model_.expansions.empty()) add(look_at_functions(result, best, report));
    if (interrupted) report.findings.push_back(interrupted_finding("these are the draws so far"));
    if (!interrupted) {
      report.evidence = laplace_evidence(*target_, backend_.aim, preparation_.modes, seed_, extra);
      report.noise = noise_parameters(*space_);
    }
    if (!interrupted) add(check_hierarchy(model_, result.draws, report.findings));
    add(failure_findings(ledger_));
    if (!interrupted) add(check_bounds(target_->parameters(), result.draws));
    name_held(report, report.findings);
    add_derived(*compiled_, *space_, result.draws);
    for (std::size_t c = static_cast<std::size_t>(result.draws.parameter_count); c < result.draws.names.size(); ++c)
      report.summary.push_back(of_column(result.draws, c));
    for (int e = 0; e < static_cast<int>(data_.size()) && !interrupted; ++e) add_fitted_rows(result.draws, e, report);
    if (!interrupted && session_.interrupted()) return stop_late(session_, task_, checkpoint_, preparation_);
    report.modes = result.modes;
    report.settings = {{"backend", what_.backend}};
    for (auto const& [name, value] : result.settings.all()) report.settings.emplace_back(name, value);
    report.settings.emplace_back("start_state", start_text(what_.start));
    if (what_.near) report.settings.emplace_back("search", search_text(session_.file, what_));
    if (model_.integrated()) add_solver(preparation_.solver, report.settings);
    if (model_.dynamics == Dynamics::discrete)
      report.settings.emplace_back("prediction", prediction_text(model_, what_.prediction));
    report.resolved_text = resolved_fit(session_, task_, what_, result.settings, preparation_.solver, seed_);
    report.ledger = preparation_.ledger;
    report.ledger.merge(ledger_);
    report.draws = std::move(result.draws);
    return conclude_fit(session_, index_, task_, checkpoint_, preparation_.solver, std::move(report), began_, interrupted);
  }

  // Into the report, with what speaks against them.
  Findings look_at_functions(FitResult const& result, std::vector<double> const& best, Report& report) const {
    FunctionParameters const parameters = function_parameters(*space_, result);
    report.functions = unknown_functions(model_, parameters);
    for (int e = 0; e < static_cast<int>(data_.size()); ++e)
      add_visits(model_, data_[static_cast<std::size_t>(e)].experiment, preparation_.solver, start_rows(what_.start),
                 parameters_at(best, e), session_.interruptible(), report.functions);
    Findings findings = check_expansions(model_, parameters.values);
    Findings const more = ranges_at(best);
    findings.insert(findings.end(), more.begin(), more.end());
    return findings;
  }

  // Of unknown functions, along every experiment at one vector of the sampled parameters, declared.
  Findings ranges_at(std::vector<double> const& values) const {
    Findings findings;
    for (int e = 0; e < static_cast<int>(data_.size()); ++e) {
      Findings const more = check_ranges(model_, data_[static_cast<std::size_t>(e)].experiment, preparation_.solver,
                                         start_rows(what_.start), parameters_at(values, e), session_.interruptible());
      findings.insert(findings.end(), more.begin(), more.end());
    }
    return findings;
  }

  // Those of the model in an experiment, SI, of the sampled ones, declared.
  LaneArray parameters_at(std::vector<double> const& values, int e) const {
    LaneArray declared(static_cast<int>(values.size()), 1), one(static_cast<int>(model_.parameters.size()), 1);
    for (std::size_t p = 0; p < values.size(); ++p) declared(static_cast<int>(p), 0) = values[p];
    space_->select(space_->values_of_declared(declared), e, one);
    return one;
  }

  // Draws tell by their weights, an optimum by where it moves. A solver that was chosen has settled the modes before.
  Findings step_check(Draws const& draws, Ledger& extra) const {
    auto const fine = make_target(preparation_.solver.finer(), session_.interruptible());
    Findings findings;
    if (draws.total() > 1)
      findings = tolerance_findings(check_tolerance(*target_, *fine, draws, extra), preparation_.solver, what_.settle);
    auto const weighty =
        std::count_if(preparation_.modes.begin(), preparation_.modes.end(), [](Mode const& each) { return each.share > 0.01; });
    if (findings.empty() && !what_.settle && (draws.total() == 1 || weighty > 1) && !preparation_.modes.empty())
      findings = check_modes(*fine, backend_.aim, preparation_.modes, preparation_.solver, seed_, extra);
    return findings;
  }

  // Bands and restoring forces over the fitted rows of an experiment, and how far the trajectories drift from constraints.
  void add_fitted_rows(Draws const& draws, int e, Report& report) const {
    Experiment const& experiment = data_[static_cast<std::size_t>(e)].experiment;
    LaneArray const columns = spread(draws, 100);
    LaneArray parameters(static_cast<int>(model_.parameters.size()), columns.width());
    space_->select(space_->values_of_declared(columns), e, parameters);
    Trajectory const trajectory(compiled_, experiment, preparation_.solver, start_rows(what_.start), session_.interruptible());
    Trajectory::Result const result = trajectory.run(parameters, prediction_noise(seed_, e));
    for (Finding& finding : drift_findings(session_.source, model_, result, experiment.name))
      report.findings.push_back(std::move(finding));
    Prediction prediction = bands_along(trajectory.quantities(), result, experiment, model_);
    for (Finding& finding : band_findings(prediction, result.failed(), result.failed(), data_.size() > 1))
      report.findings.push_back(std::move(finding));
    add_restoring_forces(model_, trajectory.quantities(), result, parameters, experiment, report.forces);
    report.predictions.push_back(std::move(prediction));
  }

  Session& session_;
  int index_;
  Task const& task_;
  FitTask const& what_;
  TaskCheckpoint checkpoint_;
  std::uint64_t seed_;
  BackendRow const& backend_;
  std::shared_ptr<CompiledModel const> compiled_;
  Model const& model_;
  std::shared_ptr<ParameterSpace const> space_;
  std::vector<ExperimentData> data_;
  std::chrono::steady_clock::time_point began_;
  Preparation preparation_;
  Ledger ledger_;
  std::unique_ptr<ModelTarget> target_;
};

}  // namespace

ExitCode run_fit(Session& session, int index, Task const& task, FitTask const& what) {
  if (!session.file.models[static_cast<std::size_t>(what.model)].processes.empty())
    return run_process_fit(session, index, task, what);
  return Fit(session, index, task, what).run();
}

}  // namespace sysid
