// The steps of `select`: candidates to one target of distances, populations, comparison with the likelihood, results.
#include "app/selection/select.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/selection/candidate.hpp"
#include "app/selection/candidate_posterior.hpp"
#include "app/selection/mcmc_refinement.hpp"
#include "app/selection/selection_checks.hpp"
#include "app/selection/selection_report.hpp"
#include "app/selection/shared_parameters.hpp"
#include "app/session/fit_target.hpp"
#include "app/session/preconditions.hpp"
#include "app/session/provenance.hpp"
#include "app/session/reporting.hpp"
#include "app/session/resolved.hpp"
#include "app/session/results.hpp"
#include "app/session/session.hpp"
#include "app/session/solver_record.hpp"
#include "app/session/task_checkpoint.hpp"
#include "core/system/files.hpp"
#include "core/system/interrupt.hpp"
#include "core/text/diagnostic.hpp"
#include "core/text/number.hpp"
#include "data/start_rule.hpp"
#include "diagnostics/bands.hpp"
#include "diagnostics/verdict.hpp"
#include "inference/table.hpp"
#include "model/simulated_parameters.hpp"
#include "report/file/selection.hpp"

namespace sysid {
namespace {

using json = nlohmann::json;

class Select {
 public:
  Select(Session& session, int index, Task const& task, SelectTask const& what)
      : session_(session),
        index_(index),
        task_(task),
        what_(what),
        set_(session.file.candidates[static_cast<std::size_t>(what.candidates)]),
        checkpoint_(session, task, what.seed),
        seed_(checkpoint_.seed()),
        began_(std::chrono::steady_clock::now()) {
    candidates_ = prepare_candidates(session, what, set_);
    checkpoint_.of_data(candidates_.front().data);
  }

  ExitCode run() {
    std::vector<std::vector<ExperimentData>> data;
    for (Candidate const& each : candidates_) data.push_back(each.data);
    if (auto const why = refusal(task_, what_, session_.file.models, data)) throw UserError(*why);
    SelectorRow const& selector = *find_selector(what_.backend);
    ModelSelectionTarget const target = make_target(false);
    RunContext context{.seed = seed_,
                       .progress = session_.progress,
                       .ledger = ledger_,
                       .interrupted = [this] { return session_.interrupted(); },
                       .checkpoint = [this](json const& state) { keep_populations(state); },
                       .checkpoint_interval = session_.options.checkpoint_interval,
                       .resume = kept_populations()};
    if (context.resume)
      session_.notices << fmt::format("{}: continuing from the checkpoint\n", task_.name);
    else
      print_data_findings(session_, task_, candidates_.front().data, candidates_.front().compiled->model);
    SelectionResult result = selector.run(target, what_.settings, context);
    if (result.failure)
      throw UserError({Severity::error,
                       result.failure->code == FindingCode::no_population ? "E6518" : "E6206",
                       result.failure->message,
                       Label{task_.span, {}},
                       {},
                       result.failure->help});
    if (result.populations.empty()) {
      session_.notices << fmt::format("{}: interrupted before the first population was complete; {} continues from there\n",
                                      task_.name, to_resume(session_.options.surface));
      return ExitCode::interrupted;
    }
    try {
      return finish(target, std::move(result));
    } catch (Interrupted const&) {
      session_.notices << fmt::format("{}: interrupted before its result was checked; {} continues from there\n", task_.name,
                                      to_resume(session_.options.surface));
      return ExitCode::interrupted;
    }
  }

 private:
  /// UserError, placed at the task, where the data do not allow the distance.
  ModelSelectionTarget make_target(bool finer) const {
    try {
      return selection_target(session_, what_, candidates_, finer);
    } catch (UserError const& error) {
      Diagnostic placed = error.diagnostic();
      if (!placed.primary) placed.primary = Label{task_.span, {}};
      throw UserError(std::move(placed));
    }
  }

  // --- what is kept
  // ------------------------------------------------------------------------------------------------------------

  // Of populations; null where there is nothing to go on from.
  std::shared_ptr<json const> kept_populations() {
    auto const stored = checkpoint_.stored();
    if (!stored) return nullptr;
    content_ = *stored;
    std::shared_ptr<json const> state;
    checkpoint_.reading([&] { state = std::make_shared<json const>(content_.at("state")); });
    return state;
  }

  // What was found from other populations is of no use any more.
  void keep_populations(json const& state) {
    if (content_.contains("state") && content_["state"] == state) return;
    content_ = {{"state", state}};
    checkpoint_.save(content_);
  }

  // False: interrupted.
  bool find_posteriors(SelectionReport const& selection, std::vector<CandidatePosterior>& posteriors) {
    json const steps = content_.value("journal", json());
    auto const content = [this](json const& kept) -> json {
      content_["journal"] = kept;
      return content_;
    };
    return checkpoint_.keep_steps(steps.is_null() ? nullptr : &steps, content, [&](Journal& journal) {
      auto found = candidate_posteriors(session_, candidates_, selection.result, seed_, journal);
      if (!found) return false;
      posteriors = std::move(*found);
      journal.save();
      return true;
    });
  }

  // False: interrupted.
  bool refine(std::vector<CandidatePosterior> const& posteriors, SelectionReport& selection, Report& report) {
    KeptChains const kept{[this](std::size_t model) -> std::shared_ptr<json const> {
                            json const chains = content_.value("chains", json::object());
                            auto const state = chains.find(std::to_string(model));
                            return state == chains.end() ? nullptr : std::make_shared<json const>(*state);
                          },
                          [this](std::size_t model, json const& state) {
                            content_["chains"][std::to_string(model)] = state;
                            checkpoint_.save(content_);
                          },
                          session_.options.checkpoint_interval};
    bool ended = false;
    checkpoint_.reading([&] {
      McmcRefinement refinement =
          refine_with_chains(session_, candidates_, posteriors, what_.settings.integer("polish_samples"), seed_, kept, selection);
      add(refinement.findings, report);
      ended = !refinement.interrupted;
    });
    return ended;
  }

  // --- the end
  // --------------------------------------------------------------------------------------------------------------------

  /// Bands of the leading model's particles; the noise has none.
  void add_predictions(SelectionReport const& selection, Report& report) const {
    Candidate const& leading = candidates_[static_cast<std::size_t>(selection.leader())];
    add_leading_predictions(leading,
                            {*leading.simulated, leading_values(selection), leading.fit.solver,
                             leading.space->dimension() == leading.simulated->dimension()},
                            seed_, session_.abandonable(), report);
  }

  LaneArray leading_values(SelectionReport const& selection) const {
    auto const lead = static_cast<std::size_t>(selection.leader());
    return candidates_[lead].simulated->values_of_declared(spread(resampled_draws(selection.result.models[lead], seed_), 100));
  }

  ExitCode finish(ModelSelectionTarget const& target, SelectionResult result) {
    bool interrupted = result.interrupted;
    SelectionReport selection = begin_selection(std::move(result));
    Candidate const& leading = candidates_[static_cast<std::size_t>(selection.leader())];
    Report report = begin_selection_report(session_, task_, what_, candidates_, selection, seed_);
    std::vector<CandidatePosterior> posteriors;
    if (!interrupted && (what_.settings.flag("cross_check") || what_.settings.flag("polish"))) {
      interrupted = !find_posteriors(selection, posteriors);
    }
    bool const checked = !interrupted && what_.settings.flag("cross_check"),
               refined = !interrupted && what_.settings.flag("polish");
    if (!interrupted) add_noise_floor(session_, candidates_, target, posteriors, selection);
    if (checked) check_by_likelihood(leading, posteriors, selection, report);
    if (!interrupted) check_simulations(leading, posteriors, selection, report);
    if (refined) {
      interrupted = !refine(posteriors, selection, report);
    }
    note_end(selection, interrupted, refined, report);
    if (!interrupted) add_predictions(selection, report);
    add_settings(selection, report);
    add_outcome(selection, report);
    keep_draws(selection.result);
    report.selection = std::move(selection);
    keep_result(session_, task_, report);
    if (interrupted) {
      session_.notices << fmt::format("{}: interrupted; continue with {}\n", task_.name, to_resume(session_.options.surface));
      return ExitCode::interrupted;
    }
    remove_file(checkpoint_.path());
    return verdict_of(report.findings).pass ? ExitCode::success : ExitCode::doubtful;
  }

  static void add(Findings const& more, Report& report) { report.findings.insert(report.findings.end(), more.begin(), more.end()); }

  SelectionReport begin_selection(SelectionResult result) const {
    SelectionReport selection;
    selection.result = std::move(result);
    name_absent(candidates_, selection.result);
    for (std::size_t k = 0; k < candidates_.size(); ++k)
      if (candidates_[k].compiled->model.integrated())
        add_solver(candidates_[k].fit.solver, selection.result.models[k].simulated_with);
    selection.distance = what_.distance.text.empty() ? "nmse" : what_.distance.text;
    selection.likelihoods.resize(candidates_.size());
    selection.resampling_seed = seed_;
    summarise_shared(session_, set_, candidates_, selection);
    return selection;
  }

  void check_by_likelihood(Candidate const& leading, std::vector<CandidatePosterior> const& posteriors, SelectionReport& selection,
                           Report& report) {
    add_likelihoods(candidates_, posteriors, selection, report.findings);
    auto const lead = static_cast<std::size_t>(selection.leader());
    FitCheck check = check_candidate(session_, leading, posteriors[lead]);
    report.fit = std::move(check.lines);
    for (FitLine& line : report.fit) line.optimum_of = leading.what->name;
    add(check.findings, report);
  }

  void check_simulations(Candidate const& leading, std::vector<CandidatePosterior> const& posteriors,
                         SelectionReport const& selection, Report& report) {
    add(solver_findings(candidates_, posteriors), report);
    add(check_threshold(selection), report);
    if (leading.compiled->model.integrated() && !leading.fit.solver.row().exact && std::isfinite(selection.result.threshold))
      add(check_distances(make_target(true), selection.leader(), selection.result, leading.fit.solver), report);
  }

  static void note_end(SelectionReport const& selection, bool interrupted, bool refined, Report& report) {
    if (interrupted)
      report.findings.push_back(interrupted_finding("these are the particles of the last complete population"));
    else if (!selection.result.ran_out)
      report.findings.push_back(
          {FindingCode::selection_ended, Severity::note, {}, "the run ended: " + selection.result.stopped_by, ""});
    bool const spread = std::any_of(selection.result.models.begin(), selection.result.models.end(),
                                    [](SelectedModel const& each) { return each.died_in == 0 && !each.parameters.empty(); });
    if (spread)
      report.findings.push_back(
          {FindingCode::width_of_threshold,
           Severity::note,
           {},
           "the sds of the particles depend on the final threshold and are not posterior sds: they are "
           "larger if the run stops early, and smaller if it stops late",
           refined ? "" : "use `polish = yes`, which continues with chains on the likelihood and prints both sds"});
  }

  void add_settings(SelectionReport const& selection, Report& report) const {
    Candidate const& first = candidates_.front();
    report.settings = {{"backend", what_.backend}};
    for (auto const& [name, value] : selection.result.settings.all()) report.settings.emplace_back(name, value);
    report.settings.emplace_back("distance", selection.distance);
    report.settings.emplace_back("start_state", start_text(first.fit.start));
    Candidate const& leading = candidates_[static_cast<std::size_t>(selection.leader())];
    if (leading.compiled->model.integrated()) add_solver(leading.fit.solver, report.settings);
    report.resolved_text = resolved_select(session_, task_, what_, seed_);
  }

  void add_outcome(SelectionReport const& selection, Report& report) const {
    report.ledger = ledger_;
    report.tables = selection_tables(selection);
    report.verdict = headline(selection, report.findings);
    add_timing(session_, began_, report);
  }

  // For predictions of this run.
  void keep_draws(SelectionResult const& result) {
    std::vector<SelectedCandidate>& kept = session_.selected[index_];
    kept.clear();
    for (SelectedModel const& model : result.models)
      kept.push_back(
          {model.probability, model.died_in > 0 ? Draws{} : resampled_draws(model, seed_), candidates_[kept.size()].fit.solver});
  }

  static std::string headline(SelectionReport const& selection, Findings const& findings) {
    SelectedModel const& best = selection.result.models[static_cast<std::size_t>(selection.leader())];
    std::string const floor = selection.floor ? fmt::format(", noise floor {}", significant(*selection.floor, 4)) : "";
    std::string const at = std::isfinite(selection.result.threshold)
                               ? fmt::format("threshold {}{}", significant(selection.result.threshold, 4), floor)
                               : "no threshold: these are draws of the priors";
    return fmt::format("`{}` has probability {:.3f} at {}; {}", best.name, best.probability, at, verdict_of(findings).headline);
  }

  Session& session_;
  int index_;
  Task const& task_;
  SelectTask const& what_;
  CandidateSet const& set_;
  TaskCheckpoint checkpoint_;
  std::uint64_t seed_;
  std::chrono::steady_clock::time_point began_;
  std::vector<Candidate> candidates_;
  Ledger ledger_;
  json content_ = json::object();  // of the checkpoint
};

}  // namespace

ExitCode run_select(Session& session, int index, Task const& task, SelectTask const& what) {
  if (find_selector(what.backend)->run == nullptr) return run_select_by_likelihood(session, index, task, what);
  return Select(session, index, task, what).run();
}

}  // namespace sysid
