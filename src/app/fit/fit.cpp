// The steps of a fit: data to target, search, step size, sampling with checkpoints, checks, results.
#include "app/fit/fit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "app/fit/advice.hpp"
#include "app/fit/derived_sds.hpp"
#include "app/fit/fit_checks.hpp"
#include "app/fit/fit_criteria.hpp"
#include "app/fit/fit_preparation.hpp"
#include "app/fit/hierarchies.hpp"
#include "app/fit/higher_place.hpp"
#include "app/session/exact_steps.hpp"
#include "app/session/fit_end.hpp"
#include "app/session/fit_target.hpp"
#include "app/session/preconditions.hpp"
#include "app/session/preparation.hpp"
#include "app/session/provenance.hpp"
#include "app/session/reporting.hpp"
#include "app/session/resolved.hpp"
#include "app/session/solver_record.hpp"
#include "app/session/solver_refinement.hpp"
#include "app/session/task_checkpoint.hpp"
#include "core/system/interrupt.hpp"
#include "data/start_rule.hpp"
#include "diagnostics/tolerance/tolerance.hpp"
#include "diagnostics/verdict.hpp"
#include "inference/automatic.hpp"
#include "inference/backend/checkpoint.hpp"
#include "inference/evidence/evidence.hpp"
#include "inference/evidence/prior_widths.hpp"
#include "inference/table.hpp"
#include "search/journal.hpp"
#include "search/search.hpp"

namespace sysid {
namespace {

using json = nlohmann::json;

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
  Fit(Session& session, int index, Task const& task, FitTask const& what)
      : Fit(session, index, task, what, TaskCheckpoint(session, task, what.seed), find_backend(what.backend)) {}

  // checkpoint: of the run, or one that is kept nowhere.
  Fit(Session& session, int index, Task const& task, FitTask const& what, TaskCheckpoint checkpoint, BackendRow const* backend)
      : session_(session),
        index_(index),
        task_(task),
        what_(what),
        checkpoint_(std::move(checkpoint)),
        seed_(checkpoint_.seed()),
        chosen_(what),
        backend_(backend),
        data_(load_experiments(session, what.experiments, session.file.models[static_cast<std::size_t>(what.model)], what.start,
                               what.prediction, what.solver)),
        likelihood_(session.file.models[static_cast<std::size_t>(what.model)].processes.empty()
                        ? independent_likelihood(session, what, data_, seed_)
                        : process_likelihood(session, what, data_, seed_)),
        model_(likelihood_->model()),
        preparing_(session, task, what, data_, *likelihood_, backend_->objective_kind, checkpoint_),
        began_(std::chrono::steady_clock::now()) {
    checkpoint_.of_data(data_);
  }

  ExitCode run() {
    if (auto const why = refusal(task_, what_, likelihood_->sampled_model(), data_)) throw UserError(*why);
    RunContext context = searching(ledger_);
    std::shared_ptr<json const> const stored = checkpoint_.stored();
    if (stored) session_.notices << fmt::format("{}: continuing from the checkpoint\n", task_.name);
    if (stored && stored->contains("preparation")) {
      preparation_ = checkpoint_.preparation(*stored);
      checkpoint_.reading([&] {
        require_method(preparation_.solver);
        likelihood_->refer(preparation_.references);
        likelihood_->standardise(preparation_.standardised);
      });
      if (stored->contains("state")) context.resume = std::make_shared<json const>(stored->at("state"));
      if (stored->contains("again") && !go_on_choosing(stored->at("again")))
        return stop_late(session_, task_, checkpoint_, preparation_);
    } else if (!prepare(stored.get())) {
      return stop_early(session_, task_, checkpoint_);
    }
    context.checkpoint = [this](json const& state) { checkpoint_.save({{"preparation", store(preparation_)}, {"state", state}}); };
    ExitCode stopped = ExitCode::interrupted;
    std::optional<FitResult> result = sample_to_end(context, stopped);
    return result ? finish(std::move(*result)) : stopped;
  }

  // Of records that are not the task's own, or by a back end that is not its own: nothing is kept. Nothing: interrupted.
  std::optional<UnkeptFit> run_unkept(std::vector<double> const& at) {
    if (auto const why = refusal(task_, what_, likelihood_->sampled_model(), data_)) throw UserError(*why);
    if (!prepare(nullptr)) return std::nullopt;
    RunContext context = searching(ledger_);
    ExitCode stopped = ExitCode::interrupted;
    std::optional<FitResult> const result = sample_to_end(context, stopped);
    if (!result || result->interrupted) return std::nullopt;
    UnkeptFit fit{begin(*result), chosen_.backend, std::nan(""), *result};
    Target const& target = likelihood_->set_target(preparation_.solver, session_.interruptible());
    FinishedFit finished = finished_fit(*result, target, fit.report);
    run_fit_checks(finished);
    name_held(fit.report, fit.report.findings);
    add_settings(result->settings, fit.report);
    fit.report.ledger = preparation_.ledger;
    fit.report.ledger.merge(ledger_);
    if (!at.empty()) fit.log_likelihood = log_likelihood(target, at);
    if (session_.interrupted()) return std::nullopt;
    return fit;
  }

 private:
  // Nothing: interrupted, with the exit code that says so in `stopped`.
  std::optional<FitResult> sample_to_end(RunContext& context, ExitCode& stopped) {
    while (true) {
      FitResult result;
      try {
        result = sample(context);
      } catch (Interrupted const&) {  // before the first iteration, or an optimum's checks
        if (!checkpoint_.kept()) checkpoint_.save({{"preparation", store(preparation_)}});
        stopped = stop_early(session_, task_, checkpoint_);
        return std::nullopt;
      }
      if (result.interrupted && result.draws.total() == 0) {
        stopped = stop_early(session_, task_, checkpoint_);
        return std::nullopt;
      }
      HigherSearch chosen = HigherSearch::nothing;
      if (std::vector<double> place = higher_place(result); !place.empty()) {
        session_.notices << fmt::format(
            "{}: searching again, from a draw whose density is higher than that of the best mode found\n", task_.name);
        chosen = choose_again({preparation_.solver, std::move(place)}, nullptr);
      }
      if (chosen == HigherSearch::nothing) {
        check_draws_of(result);
        if (!to_be_chosen_again(result)) return result;
        session_.notices << fmt::format("{}: sampling again with a finer solver: {}\n", task_.name,
                                        tolerance_findings(*accuracy_, preparation_.solver, true).front().message);
        chosen = choose_again({fine_enough(preparation_.solver, accuracy_->largest()), {}}, nullptr);
      }
      if (chosen == HigherSearch::interrupted) {
        stopped = stop_late(session_, task_, checkpoint_, preparation_);
        return std::nullopt;
      }
      context.resume = {};
    }
  }

  // Without checkpoints and known modes.
  RunContext searching(Ledger& ledger) {
    return {.seed = seed_,
            .progress = session_.progress,
            .ledger = ledger,
            .interrupted = [this] { return session_.interrupted(); },
            .checkpoint_interval = session_.options.checkpoint_interval};
  }

  FitResult sample(RunContext& context) {
    likelihood_->know_modes(preparation_.modes);
    choose_backend();
    Target const& target = likelihood_->set_target(preparation_.solver, session_.abandonable());
    if (std::string const how = likelihood_->estimated_by(); !how.empty())
      session_.notices << fmt::format("{}: {}\n", task_.name, how);
    context.modes = preparation_.modes;
    context.mode_findings = preparation_.findings;
    FitResult result = backend_->run(target, chosen_.settings, context);
    if (result.failure) {
      advise({model_, data_, preparation_.solver, ledger_}, *result.failure);
      throw UserError(no_result(task_, *result.failure));
    }
    for (Finding& each : result.findings) advise({model_, data_, preparation_.solver, preparation_.ledger}, each);
    return result;
  }

  // What `auto` stands for, by the modes.
  void choose_backend() {
    if (chosen_.backend != "auto") return;
    Target const& target = likelihood_->set_target(preparation_.solver, session_.abandonable());
    Ledger looked;
    automatic::Choice choice = automatic::choose(target, preparation_.modes, seed_, looked);
    backend_ = find_backend(choice.backend);
    chosen_.backend = choice.backend;
    chosen_.settings = Settings(backend_->settings);
    reason_ = std::move(choice.reason);
    session_.notices << fmt::format("{}: sampling with {}: {}\n", task_.name, chosen_.backend, reason_);
  }

  // Whether a finer solver moves the draws.
  void check_draws_of(FitResult const& result) {
    accuracy_.reset();
    SolverSettings const& solver = preparation_.solver;
    if (!model_.integrated() || solver.row().exact || result.interrupted || result.draws.total() < 2) return;
    if (auto const estimates = likelihood_->finer_estimates(session_.abandonable()); estimates.coarse) {
      accuracy_ = check_estimates(*estimates.coarse, *estimates.fine, result.draws, extra_);
      return;
    }
    accuracy_ = check_draws(*preparing_.target(solver), *preparing_.target(solver.finer()), result.draws, preparation_.modes, seed_,
                            extra_);
  }

  // A solver that the guard has chosen, by modes, for draws that it moves after all. Where none was fine enough for the modes, none
  // is left to choose.
  bool to_be_chosen_again(FitResult const& result) const {
    bool const settled = std::none_of(preparation_.findings.begin(), preparation_.findings.end(),
                                      [](Finding const& each) { return each.code == FindingCode::step_not_settled; });
    return what_.refine_solver && settled && !result.interrupted && !session_.interrupted() && accuracy_ && !accuracy_->holds() &&
           fine_enough(preparation_.solver, accuracy_->largest()).within_limits();
  }

  // What is to be done once more after a result: the solver from this one on, and before it the search from `place`, unless empty.
  struct Again {
    SolverSettings solver;
    std::vector<double> place;
  };

  static constexpr int most_searches = 2;

  // A place that shows that the search has missed a mode; empty where there is none. A search that the user has aimed stays there.
  std::vector<double> higher_place(FitResult const& result) {
    bool const asked = !result.interrupted && !session_.interrupted() && !what_.near && preparation_.searched_again < most_searches;
    if (!asked) return {};
    Target const& target = likelihood_->set_target(preparation_.solver, session_.abandonable());
    return place_above_modes(result, target, backend_->objective_kind, preparation_.modes,
                             likelihood_->with_hierarchies() != nullptr);
  }

  // steps: what an interrupted run has kept of it, or null. Interrupted: kept with what was sampled before, which then stays.
  // Nothing: no higher mode lies near the place, and the result stays.
  HigherSearch choose_again(Again const& from, json const* steps) {
    Preparation again = preparation_;
    RunContext context = searching(again.ledger);
    MakeTarget const make = [this](SolverSettings const& solver) { return preparing_.target(solver); };
    auto const content = [&](json const& kept) -> json {
      return {{"preparation", store(preparation_)},
              {"again",
               {{"solver", write_solver(from.solver)},
                {"place", checkpoint::encode(std::span<double const>(from.place))},
                {"ledger", checkpoint::encode(ledger_)},
                {"journal", kept}}}};
    };
    HigherSearch searched = HigherSearch::found;
    bool const chosen = checkpoint_.keep_steps(steps, content, [&](Journal& journal) {
      context.journal = &journal;
      if (!from.place.empty())
        searched = search_from_place(from.place, *preparing_.target(again.solver), backend_->objective_kind, again, context);
      if (searched == HigherSearch::nothing) return true;
      bool const ended =
          searched == HigherSearch::found &&
          (!what_.refine_solver || refine_solver(session_, task_, make, backend_->objective_kind, from.solver, again, context));
      if (!ended) journal.save();  // the sampling before is not done again
      return ended;
    });
    if (!chosen) return HigherSearch::interrupted;
    if (searched == HigherSearch::nothing) {
      preparation_.searched_again = most_searches;
    } else {
      preparation_ = std::move(again);
      preparation_.ledger.merge(ledger_);
      ledger_ = {};
      chosen_ = what_;
    }
    if (checkpoint_.kept()) checkpoint_.save({{"preparation", store(preparation_)}});
    return searched;
  }

  // Of a solver that a checkpoint holds: a run refines its steps, and keeps its method.
  void require_method(SolverSettings const& stored) const {
    if (stored.method != what_.solver.method) throw checkpoint::Mismatch("its solver is another one");
  }

  // Where a run was interrupted in `choose_again`.
  bool go_on_choosing(json const& stored) {
    Again from;
    checkpoint_.reading([&] {
      from = {read_solver(stored.at("solver")), checkpoint::decode(stored.at("place"))};
      require_method(from.solver);
      bool const fits = from.place.empty() || std::ssize(from.place) == likelihood_->space().dimension();
      if (!fits) throw checkpoint::Mismatch("its parameters differ in number");
      ledger_ = checkpoint::decode_ledger(stored.at("ledger"));
      (void)stored.at("journal");
    });
    return choose_again(from, &stored.at("journal")) != HigherSearch::interrupted;
  }

  // From what an interrupted run has kept, if there is anything. False: interrupted, and kept.
  bool prepare(json const* stored) {
    json const* steps = nullptr;
    if (stored != nullptr) checkpoint_.reading([&] { steps = &stored->at("journal"); });
    RunContext context = searching(preparation_.ledger);
    bool const prepared = checkpoint_.keep_steps(
        steps,
        [](json const& kept) -> json {
          return {{"journal", kept}};
        },
        [&](Journal& journal) {
          context.journal = &journal;
          return preparing_.run(context, preparation_);
        });
    // What took so long that it has been kept on the way is kept at its end.
    if (prepared && checkpoint_.kept()) checkpoint_.save({{"preparation", store(preparation_)}});
    return prepared;
  }

  ExitCode finish(FitResult result) {
    bool const interrupted = result.interrupted;
    Report report = begin(result);
    // Sampling must not be given up on the way, the checks may.
    Target const& target =
        likelihood_->set_target(preparation_.solver, interrupted ? session_.options.execution : session_.interruptible());
    add_derived_sds(*likelihood_, target, result, report.draws, seed_, report.summary);
    if (interrupted) report.findings.push_back(interrupted_finding("these are the draws so far"));
    if (!interrupted)  // the checks read them
      for (int e = 0; e < static_cast<int>(data_.size()); ++e)
        if (auto states = likelihood_->states(report.draws, e)) report.states.push_back(std::move(*states));
    FinishedFit finished = finished_fit(result, target, report);
    run_fit_checks(finished);
    name_held(report, report.findings);
    if (!interrupted) {
      report.functions = likelihood_->functions(result, report.draws);
      report.evidence = evidence_of(result, target, finished.extra);
      report.criteria = criteria_of(finished);
      if (report.evidence->log_evidence) report.prior_widths = prior_widths(priors_of_choice(report), report.draws);
      report.noise = noise_parameters(likelihood_->space());
    }
    if (!interrupted && session_.interrupted()) return stop_late(session_, task_, checkpoint_, preparation_);
    for (FittedRows& rows : finished.rows) report.predictions.push_back(std::move(rows.prediction));
    report.modes = result.modes;
    for (ParameterInfo const& each : target.parameters()) report.sampled_names.push_back(each.name);
    add_settings(result.settings, report);
    report.ledger = preparation_.ledger;
    report.ledger.merge(ledger_);
    return conclude_fit(session_, index_, task_, checkpoint_, preparation_.solver, std::move(report), began_, interrupted);
  }

  // What the checks read. All outlive it.
  FinishedFit finished_fit(FitResult const& result, Target const& target, Report& report) {
    FinishedFit finished{session_, what_, *likelihood_, target, data_, preparation_, result, backend_->objective_kind,
                         ledger_,  seed_, accuracy_,    report, {},    extra_};
    for (int e = 0; e < static_cast<int>(data_.size()) && !result.interrupted; ++e)
      finished.rows.push_back(likelihood_->fitted_rows(report.draws, e, report.forces));
    return finished;
  }

  // Of these declared values of the sampled parameters.
  double log_likelihood(Target const& target, std::vector<double> const& at) {
    LaneArray declared(target.dimension(), 1), theta(target.dimension(), 1);
    for (int p = 0; p < target.dimension(); ++p) declared(p, 0) = at[static_cast<std::size_t>(p)];
    target.unconstrain(declared, theta);
    double value = 0;
    target.log_likelihood(theta, {&value, 1}, extra_);
    return value;
  }

  Evidence evidence_of(FitResult const& result, Target const& target, Ledger& extra) const {
    if (Parameter const* improper = model_.improper(); improper != nullptr && backend_->objective_kind != ObjectiveKind::likelihood)
      return {{}, without_evidence(*improper)};
    EvidenceTask const asked{
        what_.evidence, backend_->objective_kind, preparation_.modes, result.draws, preparation_.ledger.solves() + ledger_.solves(),
        seed_};
    return estimate_evidence(target, asked, extra, interrupt_requested);
  }

  // Priors, data, draws and what sampling itself has found. What is wrong with the record comes before what follows from it.
  Report begin(FitResult const& result) {
    Report report = begin_report(
        session_, task_, what_.model,
        fmt::format("fit {} to {} with {}", model_.name, data_names(session_.file, what_.experiments), chosen_.backend), seed_);
    add_prediction_rule(model_, what_.prediction, report);
    report.priors = priors_of(likelihood_->space(), report.priors);
    add_fitted_data(session_.file, data_, model_, report);
    report.findings.insert(report.findings.end(), result.findings.begin(), result.findings.end());
    if (!result.search_told)
      report.findings.insert(report.findings.end(), preparation_.findings.begin(), preparation_.findings.end());
    report.draws = likelihood_->draws(result);
    report.summary = likelihood_->summaries(result, report.draws);
    for (std::size_t c = static_cast<std::size_t>(report.draws.parameter_count); c < report.draws.names.size(); ++c)
      report.summary.push_back(of_column(report.draws, c));
    return report;
  }

  void add_settings(Settings const& settings, Report& report) const {
    report.settings = {{"backend", chosen_.backend}};
    if (!reason_.empty()) report.settings.emplace_back("chosen_because", reason_);
    for (auto const& [name, value] : settings.all()) report.settings.emplace_back(name, value);
    report.settings.emplace_back("start_state", start_text(what_.start));
    if (!preparation_.standardised.empty())
      report.settings.emplace_back("non_centred", fmt::format("{}", fmt::join(non_centred(), ", ")));
    if (what_.near) report.settings.emplace_back("search", search_text(session_.file, what_));
    if (what_.evidence != EvidenceMethod::automatic) report.settings.emplace_back("evidence", std::string(word(what_.evidence)));
    if (model_.integrated()) add_solver(preparation_.solver, report.settings);
    if (model_.dynamics == Dynamics::discrete)
      report.settings.emplace_back("prediction", prediction_text(model_, what_.prediction));
    for (auto const& each : likelihood_->settings()) report.settings.push_back(each);
    report.resolved_text = resolved_fit(session_, task_, chosen_, settings, preparation_.solver, seed_);
  }

  // As declared, the parameters whose members are sampled relative to their population.
  std::vector<std::string> non_centred() const {
    return declared_names(parameters_of(*likelihood_->with_hierarchies(), preparation_.standardised));
  }

  Session& session_;
  int index_;
  Task const& task_;
  FitTask const& what_;
  TaskCheckpoint checkpoint_;
  std::uint64_t seed_;
  FitTask chosen_;  // with the back end that `auto` stands for, once it is known
  BackendRow const* backend_;
  std::string reason_;  // of that choice
  std::vector<ExperimentData> data_;
  std::unique_ptr<FitLikelihood> likelihood_;
  Model const& model_;
  FitPreparation preparing_;
  std::chrono::steady_clock::time_point began_;
  Preparation preparation_;
  Ledger ledger_;
  std::optional<SolverCheck> accuracy_;  // of the draws
  Ledger extra_;                         // of solves for checks, which no report shows
};

}  // namespace

std::optional<UnkeptFit> fit_unkept(Session& session, int index, Task const& task, FitTask const& what, std::uint64_t seed,
                                    std::vector<double> const& at, BackendRow const* backend) {
  FitTask const suited = with_exact_steps(session, what).task;
  return Fit(session, index, task, suited, TaskCheckpoint(session, task, Unkept{seed}), backend).run_unkept(at);
}

ExitCode run_fit(Session& session, int index, Task const& task, FitTask const& what) {
  auto const [suited, growing] = with_exact_steps(session, what);
  if (growing > 0)
    session.notices << fmt::format(
        "{}: {} integrates exactly: with {}, the steps grow without bound on {:.0f} % of the prior draws\n", task.name,
        suited.solver.method, accuracy(what.solver), 100 * growing);
  return Fit(session, index, task, suited).run();
}

}  // namespace sysid
