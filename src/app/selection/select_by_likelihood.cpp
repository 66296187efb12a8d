// `select` with a back end that sees likelihoods: searches, the back end, residuals of the leading model, results.
#include "app/selection/select.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/selection/candidate.hpp"
#include "app/selection/searched_candidates.hpp"
#include "app/selection/selection_checks.hpp"
#include "app/selection/selection_report.hpp"
#include "app/selection/shared_parameters.hpp"
#include "app/session/fit_end.hpp"
#include "app/session/preconditions.hpp"
#include "app/session/provenance.hpp"
#include "app/session/reporting.hpp"
#include "app/session/resolved.hpp"
#include "app/session/results.hpp"
#include "app/session/solver_record.hpp"
#include "app/session/task_checkpoint.hpp"
#include "core/system/files.hpp"
#include "core/system/interrupt.hpp"
#include "core/text/diagnostic.hpp"
#include "core/text/number.hpp"
#include "data/start_rule.hpp"
#include "diagnostics/tolerance/tolerance.hpp"
#include "diagnostics/verdict.hpp"
#include "inference/table.hpp"
#include "report/file/selection.hpp"

namespace sysid {
namespace {

using json = nlohmann::json;

/// Draws of the leading model that bands are made of.
constexpr int band_draws = 400;

class SelectByLikelihood {
 public:
  SelectByLikelihood(Session& session, int index, Task const& task, SelectTask const& what)
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
    require_same_samples(candidates_, task_.span);
    if (auto const stored = checkpoint_.stored()) {
      checkpoint_.reading([&] { content_ = stored->get<json::object_t>(); });
      session_.notices << fmt::format("{}: continuing from the checkpoint\n", task_.name);
    } else {
      print_data_findings(session_, task_, candidates_.front().data, candidates_.front().compiled->model);
    }
    if (!search()) return interrupted();
    std::optional<SelectionResult> result = select();
    if (!result) return interrupted();
    try {
      return finish(std::move(*result));
    } catch (Interrupted const&) {  // bands of fewer draws would be another result
      return interrupted();
    }
  }

 private:
  ExitCode interrupted() const {
    session_.notices << fmt::format("{}: interrupted; continue with {}\n", task_.name, to_resume(session_.options.surface));
    return ExitCode::interrupted;
  }

  /// False: interrupted.
  bool search() {
    json const steps = content_.value("journal", json());
    auto const content = [this](json const& kept) -> json {
      content_["journal"] = kept;
      return content_;
    };
    return checkpoint_.keep_steps(steps.is_null() ? nullptr : &steps, content, [&](Journal& journal) {
      auto found = search_candidates(session_, candidates_, seed_, journal, findings_);
      if (!found) return false;
      searched_ = std::move(*found);
      journal.save();
      return true;
    });
  }

  /// Nothing when interrupted.
  std::optional<SelectionResult> select() {
    std::vector<LikelihoodCandidate> all;
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      targets_.push_back(likelihood_target(session_, candidates_[k], searched_[k].solver, session_.abandonable()));
      all.push_back({candidates_[k].what->name, candidates_[k].what->probability, targets_.back().get(),
                     log_unit(candidates_[k], candidates_.front()), searched_[k].modes, searched_[k].excluded});
    }
    RunContext context{.seed = seed_,
                       .progress = session_.progress,
                       .ledger = ledger_,
                       .interrupted = [this] { return session_.interrupted(); },
                       .checkpoint =
                           [this](json const& state) {
                             content_["state"] = state;
                             checkpoint_.save(content_);
                           },
                       .checkpoint_interval = session_.options.checkpoint_interval,
                       .resume = kept_state(),
                       .checkpoint_end = true};
    SelectionResult result = find_selector(what_.backend)->run_by_likelihood(all, what_.settings, context);
    if (result.failure)
      throw UserError({Severity::error, "E6206", result.failure->message, Label{task_.span, {}}, {}, result.failure->help});
    if (result.interrupted) return std::nullopt;
    for (std::size_t k = 0; k < candidates_.size(); ++k)
      if (candidates_[k].compiled->model.integrated()) {
        result.jumps->models[k].solver = searched_[k].solver.text();
        add_solver(searched_[k].solver, result.models[k].simulated_with);
      }
    return result;
  }

  std::shared_ptr<json const> kept_state() const {
    std::shared_ptr<json const> state;
    if (content_.contains("state")) checkpoint_.reading([&] { state = std::make_shared<json const>(content_.at("state")); });
    return state;
  }

  // --- the end
  // --------------------------------------------------------------------------------------------------------------------

  ExitCode finish(SelectionResult result) {
    SelectionReport selection;
    selection.result = std::move(result);
    name_absent(candidates_, selection.result);
    selection.likelihoods.resize(candidates_.size());
    selection.resampling_seed = seed_;
    summarise_shared(session_, set_, candidates_, selection);
    auto const lead = static_cast<std::size_t>(selection.leader());
    Report report = begin_selection_report(session_, task_, what_, candidates_, selection, seed_);
    for (Findings const& more : {findings_, failure_findings(ledger_)})
      report.findings.insert(report.findings.end(), more.begin(), more.end());
    if (!searched_[lead].modes.empty()) {
      FitCheck check =
          check_candidate(session_, candidates_[lead], {searched_[lead].modes, false, searched_[lead].solver, {}, true});
      report.fit = std::move(check.lines);
      report.findings.insert(report.findings.end(), check.findings.begin(), check.findings.end());
    }
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      SelectedModel const& model = selection.result.models[k];
      if (model.probability < weight_of_interest || model.weight.empty()) continue;
      for (Finding& each : check_solver(session_, candidates_[k], resampled_draws(model, seed_), searched_[k].modes,
                                        searched_[k].solver, seed_, k == lead))
        report.findings.push_back(std::move(each));
    }
    if (!selection.result.models[lead].weight.empty()) add_predictions(lead, selection, report);
    add_settings(lead, selection, report);
    keep_draws(selection.result);
    report.tables = selection_tables(selection);
    report.verdict = headline(selection, report.findings);
    report.selection = std::move(selection);
    keep_result(session_, task_, report);
    remove_file(checkpoint_.path());
    return verdict_of(report.findings).pass ? ExitCode::success : ExitCode::doubtful;
  }

  /// Bands of the leading model's draws over the fitted rows, noise included.
  void add_predictions(std::size_t lead, SelectionReport const& selection, Report& report) const {
    Candidate const& leading = candidates_[lead];
    LaneArray values = leading.space->values_of_declared(spread(resampled_draws(selection.result.models[lead], seed_), band_draws));
    add_leading_predictions(leading, {*leading.space, std::move(values), searched_[lead].solver, true}, seed_,
                            session_.abandonable(), report);
  }

  void add_settings(std::size_t lead, SelectionReport const& selection, Report& report) const {
    report.settings = {{"backend", what_.backend}};
    for (auto const& [name, value] : selection.result.settings.all()) report.settings.emplace_back(name, value);
    report.settings.emplace_back("start_state", start_text(candidates_.front().fit.start));
    if (candidates_[lead].compiled->model.integrated()) add_solver(searched_[lead].solver, report.settings);
    report.resolved_text = resolved_select(session_, task_, what_, seed_);
    report.ledger = ledger_;
    add_timing(session_, began_, report);
  }

  /// For predictions of this run: the parameters that a simulation reads, as a later run takes them from the files.
  void keep_draws(SelectionResult const& result) {
    std::vector<SelectedCandidate>& kept = session_.selected[index_];
    kept.clear();
    for (std::size_t k = 0; k < result.models.size(); ++k) {
      Draws const all = resampled_draws(result.models[k], seed_);
      Draws draws;
      std::vector<std::size_t> columns;
      for (ParameterInfo const& info : candidates_[k].simulated->infos()) {
        columns.push_back(static_cast<std::size_t>(std::find(all.names.begin(), all.names.end(), info.name) - all.names.begin()));
        draws.names.push_back(info.name);
        draws.units.push_back(all.units[columns.back()]);
      }
      draws.parameter_count = static_cast<int>(columns.size());
      draws.chains.resize(1);
      for (std::vector<double> const& row : all.chains.front().values) {
        draws.chains.front().values.emplace_back();
        for (std::size_t const c : columns) draws.chains.front().values.back().push_back(row[c]);
      }
      kept.push_back({result.models[k].probability, std::move(draws), searched_[k].solver});
    }
  }

  static std::string headline(SelectionReport const& selection, Findings const& findings) {
    auto const lead = static_cast<std::size_t>(selection.leader());
    SelectedModel const& best = selection.result.models[lead];
    double const error = selection.result.jumps->models[lead].error;
    std::string const sure =
        best.probability > 0.9995 && error < 1e-4 ? "above 0.999" : fmt::format("{:.3f} ± {:.1g}", best.probability, error);
    return fmt::format("`{}` has probability {}; {}", best.name, sure, verdict_of(findings).headline);
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
  std::vector<SearchedCandidate> searched_;
  std::vector<std::unique_ptr<ModelTarget>> targets_;
  Findings findings_;  // of the searches
  Ledger ledger_;
  json content_ = json::object();  // of the checkpoint
};

}  // namespace

ExitCode run_select_by_likelihood(Session& session, int index, Task const& task, SelectTask const& what) {
  return SelectByLikelihood(session, index, task, what).run();
}

}  // namespace sysid
