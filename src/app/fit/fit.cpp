// The end of a fit: from its draws to checks, evidence and report.
#include "app/fit/fit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>

#include "app/fit/derived_sds.hpp"
#include "app/fit/fit_checks.hpp"
#include "app/fit/fit_criteria.hpp"
#include "app/fit/fit_sampling.hpp"
#include "app/fit/hierarchies.hpp"
#include "app/session/exact_steps.hpp"
#include "app/session/fit_end.hpp"
#include "app/session/preconditions.hpp"
#include "app/session/preparation.hpp"
#include "app/session/provenance.hpp"
#include "app/session/reporting.hpp"
#include "app/session/resolved.hpp"
#include "app/session/solver_record.hpp"
#include "app/session/task_checkpoint.hpp"
#include "core/system/interrupt.hpp"
#include "data/start_rule.hpp"
#include "diagnostics/model_checks.hpp"
#include "diagnostics/prior_checks.hpp"
#include "diagnostics/tolerance/tolerance.hpp"
#include "diagnostics/verdict.hpp"
#include "inference/backend/checkpoint.hpp"
#include "inference/evidence/evidence.hpp"
#include "inference/evidence/prior_widths.hpp"
#include "inference/table.hpp"

namespace sysid {
namespace {

/// Those that the user has chosen: coefficients of unknown functions have the prior that their kernel gives them.
std::vector<PriorInfo> priors_of_choice(Report const& report) {
  std::vector<PriorInfo> chosen;
  for (PriorInfo const& prior : report.priors) {
    auto const of_function = [&](Summary const& each) { return each.name == prior.name && each.coefficient; };
    if (std::none_of(report.summary.begin(), report.summary.end(), of_function)) chosen.push_back(prior);
  }
  return chosen;
}

std::string without_evidence(Parameter const& improper) {
  return fmt::format("the prior of `{}` is improper ({}): an evidence would have an arbitrary factor", improper.name,
                     improper.prior->row->name);
}

class Fit {
 public:
  // checkpoint: of the run, or one that is kept nowhere.
  Fit(Session& session, int index, Task const& task, FitTask const& what, TaskCheckpoint checkpoint, BackendRow const* backend)
      : session_(session),
        index_(index),
        task_(task),
        what_(what),
        sampling_(session, task, what, std::move(checkpoint), backend),
        data_(sampling_.data()),
        likelihood_(sampling_.likelihood()),
        model_(sampling_.model()),
        preparation_(sampling_.preparation()),
        began_(std::chrono::steady_clock::now()) {}

  ExitCode run() {
    std::optional<FitResult> result = sampling_.run();
    return result ? finish(std::move(*result)) : sampling_.stopped();
  }

  // Of records that are not the task's own, or by a back end that is not its own: nothing is kept. Nothing: interrupted.
  std::optional<UnkeptFit> run_unkept(std::vector<double> const& at) {
    std::optional<FitResult> const result = sampling_.run_unkept();
    if (!result) return std::nullopt;
    UnkeptFit fit{begin(*result), sampling_.chosen().backend, std::nan(""), *result};
    Target const& target = likelihood_.set_target(preparation_.solver, session_.interruptible());
    FinishedFit finished = finished_fit(*result, target, fit.report);
    run_fit_checks(finished);
    name_held(fit.report, fit.report.findings);
    name_negative_values(likelihood_.model(), fit.report.findings);
    add_settings(result->settings, fit.report);
    fit.report.ledger = sampling_.whole_ledger();
    if (!at.empty()) fit.log_likelihood = log_likelihood(target, at);
    if (session_.interrupted()) return std::nullopt;
    return fit;
  }

 private:
  ExitCode finish(FitResult result) {
    bool const interrupted = result.interrupted;
    Report report = begin(result);
    // Sampling must not be given up on the way, the checks may.
    Target const& target =
        likelihood_.set_target(preparation_.solver, interrupted ? session_.options.execution : session_.interruptible());
    add_derived_sds(likelihood_, target, result, report.draws, sampling_.seed(), report.summary);
    if (interrupted) report.findings.push_back(interrupted_finding("these are the draws so far"));
    if (!interrupted)  // the checks read them
      for (int e = 0; e < static_cast<int>(data_.size()); ++e)
        if (auto states = likelihood_.states(report.draws, e)) report.states.push_back(std::move(*states));
    FinishedFit finished = finished_fit(result, target, report);
    run_fit_checks(finished);
    name_held(report, report.findings);
    name_negative_values(likelihood_.model(), report.findings);
    if (!interrupted) {
      report.functions = likelihood_.functions(result, report.draws);
      report.evidence = evidence_of(result, target, finished.extra);
      report.criteria = criteria_of(finished);
      if (report.evidence->log_evidence) report.prior_widths = prior_widths(priors_of_choice(report), report.draws);
      report.noise = noise_parameters(likelihood_.space());
    }
    if (!interrupted && session_.interrupted()) return stop_late(session_, task_, sampling_.checkpoint(), preparation_);
    for (FittedRows& rows : finished.rows) report.predictions.push_back(std::move(rows.prediction));
    report.modes = result.modes;
    for (ParameterInfo const& each : target.parameters()) report.sampled_names.push_back(each.name);
    add_settings(result.settings, report);
    report.ledger = sampling_.whole_ledger();
    return conclude_fit(session_, index_, task_, sampling_.checkpoint(), preparation_.solver, std::move(report), began_,
                        interrupted);
  }

  // What the checks read. All outlive it.
  FinishedFit finished_fit(FitResult const& result, Target const& target, Report& report) {
    FinishedFit finished{.session = session_,
                         .what = what_,
                         .likelihood = likelihood_,
                         .target = target,
                         .data = data_,
                         .preparation = preparation_,
                         .result = result,
                         .objective_kind = sampling_.objective_kind(),
                         .sampling = sampling_.ledger(),
                         .seed = sampling_.seed(),
                         .accuracy = sampling_.accuracy(),
                         .report = report,
                         .rows = {},
                         .extra = sampling_.extra()};
    for (int e = 0; e < static_cast<int>(data_.size()) && !result.interrupted; ++e)
      finished.rows.push_back(likelihood_.fitted_rows(report.draws, e, report.forces));
    return finished;
  }

  // Of these declared values of the sampled parameters.
  double log_likelihood(Target const& target, std::vector<double> const& at) {
    LaneArray declared(target.dimension(), 1), theta(target.dimension(), 1);
    for (int p = 0; p < target.dimension(); ++p) declared(p, 0) = at[static_cast<std::size_t>(p)];
    target.unconstrain(declared, theta);
    double value = 0;
    target.log_likelihood(theta, {&value, 1}, sampling_.extra());
    return value;
  }

  Evidence evidence_of(FitResult const& result, Target const& target, Ledger& extra) const {
    if (Parameter const* improper = model_.improper();
        improper != nullptr && sampling_.objective_kind() != ObjectiveKind::likelihood)
      return {{}, without_evidence(*improper)};
    EvidenceTask const asked{what_.evidence, sampling_.objective_kind(),        preparation_.modes,
                             result.draws,   sampling_.whole_ledger().solves(), sampling_.seed()};
    return estimate_evidence(target, asked, extra, interrupt_requested);
  }

  // Priors, data, draws and what sampling itself has found. What is wrong with the record comes before what follows from it.
  Report begin(FitResult const& result) {
    Report report = begin_report(
        session_, task_, what_.model,
        fmt::format("fit {} to {} with {}", model_.name, data_names(session_.file, what_.experiments), sampling_.chosen().backend),
        sampling_.seed());
    add_prediction_rule(model_, what_.prediction, report);
    report.priors = priors_of(likelihood_.space(), report.priors);
    add_fitted_data(session_.file, data_, model_, report);
    report.findings.insert(report.findings.end(), result.findings.begin(), result.findings.end());
    if (!result.search_told)
      report.findings.insert(report.findings.end(), preparation_.findings.begin(), preparation_.findings.end());
    report.draws = likelihood_.draws(result);
    report.summary = likelihood_.summaries(result, report.draws);
    for (std::size_t c = static_cast<std::size_t>(report.draws.parameter_count); c < report.draws.names.size(); ++c)
      report.summary.push_back(of_column(report.draws, c));
    return report;
  }

  void add_settings(Settings const& settings, Report& report) const {
    report.settings = {{"backend", sampling_.chosen().backend}};
    if (!sampling_.reason().empty()) report.settings.emplace_back("chosen_because", sampling_.reason());
    for (auto const& [name, value] : settings.all()) report.settings.emplace_back(name, value);
    report.settings.emplace_back("start_state", start_text(what_.start));
    if (!preparation_.standardised.empty())
      report.settings.emplace_back("non_centred", fmt::format("{}", fmt::join(non_centred(), ", ")));
    if (what_.near) report.settings.emplace_back("search", search_text(session_.file, what_));
    if (what_.evidence != EvidenceMethod::automatic) report.settings.emplace_back("evidence", std::string(word(what_.evidence)));
    if (model_.integrated()) add_solver(preparation_.solver, report.settings);
    if (model_.dynamics == Dynamics::discrete)
      report.settings.emplace_back("prediction", prediction_text(model_, what_.prediction));
    for (auto const& each : likelihood_.settings()) report.settings.push_back(each);
    report.resolved_text = resolved_fit(session_, task_, sampling_.chosen(), settings, preparation_.solver, sampling_.seed());
  }

  // As declared, the parameters whose members are sampled relative to their population.
  std::vector<std::string> non_centred() const {
    return declared_names(parameters_of(*likelihood_.with_hierarchies(), preparation_.standardised));
  }

  Session& session_;
  int index_;
  Task const& task_;
  FitTask const& what_;
  FitSampling sampling_;
  std::vector<ExperimentData> const& data_;
  FitLikelihood& likelihood_;
  Model const& model_;
  Preparation const& preparation_;
  std::chrono::steady_clock::time_point began_;
};

}  // namespace

std::optional<UnkeptFit> fit_unkept(Session& session, int index, Task const& task, FitTask const& what, std::uint64_t seed,
                                    std::vector<double> const& at, BackendRow const* backend) {
  FitTask const suited = with_exact_steps(session, what).task;
  return Fit(session, index, task, suited, TaskCheckpoint(session, task, Unkept{seed}), backend).run_unkept(at);
}

ExitCode run_fit(Session& session, int index, Task const& task, FitTask const& what) {
  SuitedTask const suited = with_exact_steps(session, what);
  if (suited.growing > 0) session.notices << exact_notice(task.name, what.solver, suited);
  return Fit(session, index, task, suited.task, TaskCheckpoint(session, task, what.seed), find_backend(what.backend)).run();
}

}  // namespace sysid
