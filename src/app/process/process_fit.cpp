// `fit` of a model with Gaussian processes: search by gradient, back end, integrated coefficients drawn, scores of samples left
// out.
#include "app/process/process_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/process/process_draws.hpp"
#include "app/process/process_functions.hpp"
#include "app/process/process_scores.hpp"
#include "app/session/derived_draws.hpp"
#include "app/session/fit_end.hpp"
#include "app/session/fit_target.hpp"
#include "app/session/preconditions.hpp"
#include "app/session/preparation.hpp"
#include "app/session/provenance.hpp"
#include "app/session/reporting.hpp"
#include "app/session/resolved.hpp"
#include "app/session/search_near.hpp"
#include "app/session/solver_record.hpp"
#include "app/session/solver_refinement.hpp"
#include "app/session/task_checkpoint.hpp"
#include "data/start_rule.hpp"
#include "diagnostics/bands.hpp"
#include "diagnostics/bound_check.hpp"
#include "diagnostics/convergence.hpp"
#include "diagnostics/fit_checks.hpp"
#include "diagnostics/tolerance.hpp"
#include "diagnostics/verdict.hpp"
#include "inference/evidence.hpp"
#include "inference/table.hpp"
#include "search/search.hpp"

namespace sysid {
namespace {

using json = nlohmann::json;

class ProcessFit {
 public:
  ProcessFit(Session& session, int index, Task const& task, FitTask const& what)
      : session_(session),
        index_(index),
        task_(task),
        what_(what),
        checkpoint_(session, task, what.seed),
        seed_(checkpoint_.seed()),
        backend_(*find_backend(what.backend)),
        model_(process_model(session, what, what.prediction)),
        data_(load_experiments(session, what.experiments, session.file.models[static_cast<std::size_t>(what.model)], what.start,
                               what.prediction)),
        began_(std::chrono::steady_clock::now()) {
    checkpoint_.of_data(data_);
  }

  ExitCode run() {
    if (auto const why = refusal(task_, what_, model_->reduced(), data_)) throw UserError(*why);
    RunContext context{seed_,   session_.progress,
                       ledger_, [this] { return session_.interrupted(); },
                       {},      session_.options.checkpoint_interval,
                       {},      {},
                       {}};
    if (std::shared_ptr<json const> const stored = checkpoint_.stored()) {
      preparation_ = restore_preparation(stored->at("preparation"));
      if (stored->contains("state")) context.resume = std::make_shared<json const>(stored->at("state"));
      session_.notices << fmt::format("{}: going on from the checkpoint\n", task_.name);
    } else {
      tell_of_data(session_, task_, data_, model_->model());
      RunContext searching{
          seed_, session_.progress, preparation_.ledger, context.interrupted, {}, context.checkpoint_interval, {}, {}, {}};
      if (!prepare(searching)) return stop_early(session_, task_, checkpoint_);
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
  std::unique_ptr<ProcessTarget> make_target(SolverSettings const& solver, ExecutionOptions const& execution) const {
    return process_target(what_, model_, data_, solver, execution);
  }

  // Search and, where equations are integrated and the user did not fix it, the step. False: interrupted.
  bool prepare(RunContext& context) {
    preparation_.solver = what_.solver;
    auto const target = make_target(what_.solver, session_.interruptible());
    SearchResult found =
        what_.near ? search_near(session_, *what_.near, *target, backend_.aim, context) : search(*target, backend_.aim, context);
    if (found.interrupted) return false;
    if (found.failure) throw UserError(no_result(task_, *found.failure));
    preparation_.modes = std::move(found.modes);
    preparation_.findings = std::move(found.findings);
    MakeTarget const make = [this](SolverSettings const& solver) { return make_target(solver, session_.interruptible()); };
    return !what_.settle || settle(session_, task_, make, backend_.aim, what_.solver, preparation_, context);
  }

  // As of a fit without processes: draws tell by their weights, an optimum by where it moves.
  Findings step_check(Draws const& draws) {
    auto const fine = make_target(preparation_.solver.finer(), session_.interruptible());
    Ledger extra;
    Findings findings;
    if (draws.total() > 1)
      findings = tolerance_findings(check_tolerance(*target_, *fine, draws, extra), preparation_.solver, what_.settle);
    if (findings.empty() && !what_.settle && !preparation_.modes.empty())
      findings = check_modes(*fine, backend_.aim, preparation_.modes, preparation_.solver, seed_, extra);
    return findings;
  }

  ExitCode finish(FitResult result) {
    bool const interrupted = result.interrupted;
    Model const& model = model_->model();
    Report report = begin_report(
        session_, task_, what_.model,
        fmt::format("fit {} to {} with {}", model.name, data_names(session_.file, what_.experiments), what_.backend), seed_);
    auto const all = parameter_space(model, what_.experiments);
    report.priors = priors_of(*all, report.priors);
    report.findings = result.findings;
    for (ExperimentData const& each : data_) add_data(session_.file, each, model, report);
    auto const add = [&](Findings const& more) { report.findings.insert(report.findings.end(), more.begin(), more.end()); };
    if (!result.search_told) add(preparation_.findings);
    if (interrupted) report.findings.push_back(interrupted_finding("these are the draws so far"));
    add(failure_findings(ledger_));
    add(check_use(model, what_.start));
    if (!interrupted) add(check_bounds(target_->parameters(), result.draws));
    if (!interrupted && model.integrated()) add(step_check(result.draws));
    std::vector<Summary> const sampled = summarise(result);
    report.draws = with_coefficients(*target_, *all, result.draws, seed_);
    report.summary = summaries(*all, sampled, report.draws);
    add_derived(*compiled_white(), *all, report.draws);
    for (std::size_t c = static_cast<std::size_t>(report.draws.parameter_count); c < report.draws.names.size(); ++c)
      report.summary.push_back(of_column(report.draws, c));
    if (!interrupted) {
      Ledger extra;
      report.evidence = laplace_evidence(*target_, backend_.aim, preparation_.modes, seed_, extra);
      report.noise = noise_parameters(*all);
      ProcessScores scores = score_left_out(*target_, *all, parameters_of_best(report.draws), data_);
      report.fit = std::move(scores.lines);
      add(scores.findings);
      report.functions = process_functions(*target_, *all, report.draws);
      for (int e = 0; e < static_cast<int>(data_.size()); ++e) report.predictions.push_back(fitted_rows(*all, report.draws, e));
    }
    if (!interrupted && session_.interrupted()) return stop_late(session_, task_, checkpoint_, preparation_);
    report.modes = result.modes;
    report.settings = {{"backend", what_.backend}};
    for (auto const& [name, value] : result.settings.all()) report.settings.emplace_back(name, value);
    report.settings.emplace_back("start_state", start_text(what_.start));
    if (what_.near) report.settings.emplace_back("search", search_text(session_.file, what_));
    if (model.integrated()) add_solver(preparation_.solver, report.settings);
    if (model.dynamics == Dynamics::discrete) report.settings.emplace_back("prediction", prediction_text(model, what_.prediction));
    auto const marginalised = model_->marginalised();
    if (!marginalised.empty()) report.settings.emplace_back("integrated_out", fmt::format("{}", fmt::join(marginalised, ", ")));
    report.resolved_text = resolved_fit(session_, task_, what_, result.settings, preparation_.solver, seed_);
    report.ledger = preparation_.ledger;
    report.ledger.merge(ledger_);
    return conclude_fit(session_, index_, task_, checkpoint_, preparation_.solver, std::move(report), began_, interrupted);
  }

  std::shared_ptr<CompiledModel const> compiled_white() const {
    Model white = model_->model();
    remove_processes(white);
    return compile(std::move(white), what_.start.kind == StartRule::Kind::estimated, what_.solver.method);
  }

  // Of every parameter in the user's order: of what was sampled as the back end says, of what was integrated out the draws; at an
  // optimum the width that the rest leaves it.
  std::vector<Summary> summaries(ParameterSpace const& all, std::vector<Summary> const& sampled, Draws const& draws) const {
    std::vector<Summary> result;
    auto const sds = draws.total() == 1 ? coefficient_sds(*target_, all, parameters_of_best(draws))
                                        : std::vector<std::pair<std::string, double>>{};
    for (std::size_t p = 0; p < all.infos().size(); ++p) {
      std::string const& name = all.infos()[p].name;
      auto const own = std::find_if(sampled.begin(), sampled.end(), [&](Summary const& each) { return each.name == name; });
      result.push_back(own != sampled.end() ? *own : of_column(draws, p));
      for (auto const& [coefficient, sd] : sds)
        if (coefficient == name) result.back().sd = sd;
    }
    return result;
  }

  static std::vector<double> parameters_of_best(Draws const& draws) {
    std::vector<double> best = best_draw(draws);
    best.resize(static_cast<std::size_t>(draws.parameter_count));
    return best;
  }

  Prediction fitted_rows(ParameterSpace const& all, Draws const& draws, int e) const {
    ProcessForecast const forecast(target_, model_, data_[static_cast<std::size_t>(e)].experiment, preparation_.solver,
                                   start_rows(what_.start), session_.options.execution);
    LaneArray const columns = spread(draws, 100);
    LaneArray own(static_cast<int>(model_->model().parameters.size()), columns.width());
    all.select(all.values_of_declared(columns), e, own);
    Trajectory::Result const result = forecast_draws(forecast, all, columns, own, 100, prediction_noise(seed_, e));
    return bands_along(forecast.quantities(), result, data_[static_cast<std::size_t>(e)].experiment, model_->model());
  }

  Session& session_;
  int index_;
  Task const& task_;
  FitTask const& what_;
  TaskCheckpoint checkpoint_;
  std::uint64_t seed_;
  BackendRow const& backend_;
  std::shared_ptr<ProcessModel const> model_;
  std::vector<ExperimentData> data_;
  std::shared_ptr<ProcessTarget const> target_;
  std::chrono::steady_clock::time_point began_;
  Preparation preparation_;
  Ledger ledger_;
};

}  // namespace

std::shared_ptr<ProcessModel const> process_model(Session const& session, FitTask const& fit, PredictionRule prediction) {
  auto ruled = with_prediction(session.file.models[static_cast<std::size_t>(fit.model)], prediction);
  if (!ruled) throw InternalError("a prediction rule was let through that the model has no data for");
  return std::make_shared<ProcessModel const>(std::move(*ruled), fit.start.kind == StartRule::Kind::estimated, fit.solver.method);
}

std::unique_ptr<ProcessTarget> process_target(FitTask const& fit, std::shared_ptr<ProcessModel const> model,
                                              std::vector<ExperimentData> const& data, SolverSettings const& solver,
                                              ExecutionOptions const& execution) {
  TargetOptions options;
  options.solver = solver;
  options.start_rows = start_rows(fit.start);
  options.execution = execution;
  auto const space = parameter_space(model->reduced(), fit.experiments);
  return std::make_unique<ProcessTarget>(std::move(model), space, experiments_of(data), std::move(options));
}

ExitCode run_process_fit(Session& session, int index, Task const& task, FitTask const& what) {
  return ProcessFit(session, index, task, what).run();
}

}  // namespace sysid
