// `select`: candidates to one target of distances, populations, what the likelihood says of the same, results.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "app/bands.hpp"
#include "app/experiments.hpp"
#include "app/fit_target.hpp"
#include "app/likelihood_check.hpp"
#include "app/readiness.hpp"
#include "app/reporting.hpp"
#include "app/resolved.hpp"
#include "app/results.hpp"
#include "app/session.hpp"
#include "app/solver_record.hpp"
#include "app/task_checkpoint.hpp"
#include "core/diagnostic.hpp"
#include "core/elementary.hpp"
#include "core/files.hpp"
#include "inference/mh.hpp"
#include "inference/verdict.hpp"
#include "likelihood/model_selection_target.hpp"
#include "likelihood/simulated_parameters.hpp"
#include "likelihood/trajectory.hpp"
#include "report/number.hpp"
#include "report/result.hpp"
#include "report/terminal.hpp"

namespace sysid {
namespace {

using json = nlohmann::json;

/// A model that is less probable is not polished.
constexpr double worth_polishing = 0.01;

/// A threshold further above the noise floor than this leaves more than the noise does.
constexpr double far_above_floor = 1.15;

/// A finer solver may move the median distance by this part of the threshold.
constexpr double tolerable_shift = 0.05;

/// One candidate with all that simulates it.
struct Candidate {
  CandidateModel const* what;
  FitTask const* fit;
  std::shared_ptr<CompiledModel const> compiled;
  std::vector<ExperimentData> data;
  std::shared_ptr<ParameterSpace const> space, simulated;  // of all parameters; of those that a simulation without noise reads
  DistanceMeasure measure;
};

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
    for (std::size_t k = 0; k < set_.models.size(); ++k) candidates_.push_back(prepare(k));
    checkpoint_.of_data(candidates_.front().data);
  }

  ExitCode run() {
    std::vector<std::vector<ExperimentData>> data;
    for (Candidate const& each : candidates_) data.push_back(each.data);
    if (auto const why = refusal(task_, what_, session_.file.models, data)) throw UserError(*why);
    SelectorRow const& selector = *find_selector(what_.backend);
    ModelSelectionTarget const target = make_target(false);
    RunContext context{seed_,
                       session_.progress,
                       ledger_,
                       [this] { return session_.interrupted(); },
                       [this](json const& state) { checkpoint_.save(state); },
                       session_.options.checkpoint_interval,
                       checkpoint_.stored(),
                       {},
                       {}};
    if (context.resume) session_.notices << fmt::format("{}: going on from the checkpoint\n", task_.name);
    SelectionResult result = selector.run(target, what_.settings, context);
    if (result.failure)
      throw UserError({Severity::error,
                       result.failure->code == "no_population" ? "E6518" : "E6206",
                       result.failure->message,
                       Label{task_.span, {}},
                       {},
                       result.failure->help});
    if (result.populations.empty()) {
      session_.notices << fmt::format("{}: interrupted before the first population was whole; --resume goes on from there\n",
                                      task_.name);
      return ExitCode::interrupted;
    }
    return finish(target, std::move(result));
  }

 private:
  Candidate prepare(std::size_t k) {
    FitTask const& fit = what_.fits[k];
    Candidate candidate;
    candidate.what = &set_.models[k];
    candidate.fit = &fit;
    candidate.compiled =
        session_.compiled(fit.model, fit.start.kind == StartRule::Kind::estimated, fit.solver.method, fit.prediction);
    candidate.data = load_experiments(session_, fit.experiments, fit.model, fit.start, fit.prediction);
    Model const& model = candidate.compiled->model;
    candidate.space = parameter_space(model, fit.experiments);
    candidate.simulated = parameter_space(without_noise_parameters(model), fit.experiments);
    candidate.measure = measure(k, model);
    return candidate;
  }

  /// The distance rule in terms of one model's channels.
  DistanceMeasure measure(std::size_t k, Model const& model) const {
    DistanceRule const& rule = what_.distance;
    DistanceMeasure measure;
    measure.kind = rule.kind == DistanceRule::Kind::nmse   ? DistanceKind::nmse
                   : rule.kind == DistanceRule::Kind::rmse ? DistanceKind::rmse
                                                           : DistanceKind::mean;
    for (Channel const& channel : model.channels) {
      auto const found = std::find(rule.channels.begin(), rule.channels.end(), channel.name);
      auto const c = static_cast<std::size_t>(found - rule.channels.begin());
      bool const known = found != rule.channels.end();
      measure.weights.push_back(known ? rule.weights[c] : 0);
      if (measure.kind == DistanceKind::mean)
        measure.expressions.push_back(known ? std::optional(rule.expressions[k][c]) : std::nullopt);
    }
    return measure;
  }

  /// UserError, placed at the task, where the data do not allow the distance.
  ModelSelectionTarget make_target(bool finer) const {
    try {
      return ModelSelectionTarget(describe_candidates(finer));
    } catch (UserError const& error) {
      Diagnostic placed = error.diagnostic();
      if (!placed.primary) placed.primary = Label{task_.span, {}};
      throw UserError(std::move(placed));
    }
  }

  std::vector<SelectionCandidate> describe_candidates(bool finer) const {
    std::vector<SelectionCandidate> all;
    for (Candidate const& each : candidates_) {
      TargetOptions options;
      options.solver = finer ? each.fit->solver.finer() : each.fit->solver;
      options.start_rows = start_rows(each.fit->start);
      options.execution = session_.options.execution;
      options.describe = [this, model = each.fit->model](NodeId node, Graph const& graph) {
        return session_.describe(model, graph, node);
      };
      all.push_back({each.what->name, each.what->probability, each.compiled, each.simulated, experiments_of(each.data),
                     each.measure, std::move(options)});
    }
    return all;
  }

  // --- what the likelihood says
  // -------------------------------------------------------------------------------------------------

  /// Modes of each candidate's likelihood near its particles.
  std::vector<std::vector<Mode>> find_modes(SelectionResult const& result) {
    std::vector<std::vector<Mode>> modes;
    Ledger extra;
    session_.progress.begin("the likelihood's side", candidates_.size());
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      modes.push_back(modes_near(*likelihood_target(k), result.models[k], seed_, extra));
      session_.progress.advance(k + 1, result.models[k].name);
    }
    session_.progress.end();
    return modes;
  }

  std::unique_ptr<ModelTarget> likelihood_target(std::size_t k) const {
    Candidate const& each = candidates_[k];
    return make_fit_target(session_, *each.fit, each.compiled, each.space, experiments_of(each.data), each.fit->solver);
  }

  static void add_likelihoods(std::vector<std::vector<Mode>> const& modes, SelectionReport& selection, Findings& findings) {
    std::vector<double> logs, probabilities;
    double highest = -std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < modes.size(); ++k) {
      logs.push_back(log_evidence(modes[k]));
      highest = std::max(highest, logs[k] + elementary::log(selection.result.models[k].prior));
    }
    if (!std::isfinite(highest)) return;
    double total = 0;
    for (std::size_t k = 0; k < logs.size(); ++k) {
      probabilities.push_back(elementary::exp(logs[k] + elementary::log(selection.result.models[k].prior) - highest));
      total += probabilities.back();
    }
    for (std::size_t k = 0; k < logs.size(); ++k) {
      probabilities[k] /= total;
      selection.likelihoods[k] = LikelihoodCheck{logs[k], probabilities[k]};
    }
    for (Finding& finding : compare_probabilities(selection.result, probabilities)) findings.push_back(std::move(finding));
  }

  /// What noise leaves of the leading model's distance: the noise it states, or where a prior leaves that open the one that its
  /// mode has found.
  void add_floor(ModelSelectionTarget const& target, std::vector<std::vector<Mode>> const& modes, SelectionReport& selection,
                 Findings& findings) const {
    auto const lead = static_cast<std::size_t>(selection.leader());
    Candidate const& candidate = candidates_[lead];
    Model const& model = candidate.compiled->model;
    bool const stated = candidate.space->dimension() == candidate.simulated->dimension();
    LaneArray declared(candidate.space->dimension(), 1);
    if (stated) {
      SelectedModel const& best = selection.result.models[lead];
      for (int d = 0; d < declared.rows(); ++d) declared(d, 0) = best.summaries[static_cast<std::size_t>(d)].mean;
    } else {
      if (modes.empty() || modes[lead].empty()) return;
      for (int d = 0; d < declared.rows(); ++d) declared(d, 0) = modes[lead].front().declared[static_cast<std::size_t>(d)];
    }
    std::vector<double> variance(model.channels.size());
    std::string words;
    for (std::size_t c = 0; c < model.channels.size(); ++c) {
      if (candidate.measure.weights[c] == 0) continue;
      if (model.channels[c].noise.row->name != "normal") return;
      double sum = 0, count = 0;
      for (std::size_t e = 0; e < candidate.data.size(); ++e) {
        Experiment const& experiment = candidate.data[e].experiment;
        LaneArray parameters(static_cast<int>(model.parameters.size()), 1);
        candidate.space->select(candidate.space->values_of_declared(declared), static_cast<int>(e), parameters);
        Trajectory const trajectory(candidate.compiled, experiment, candidate.fit->solver, start_rows(candidate.fit->start),
                                    session_.options.execution);
        auto const arguments = trajectory.noise_arguments(parameters, static_cast<int>(c));
        for (std::size_t i = 0; i < arguments.size(); ++i)
          if (experiment.scored[i] != 0 && !experiment.measured[c].empty() && std::isfinite(experiment.measured[c][i]))
            sum += arguments[i][1] * arguments[i][1], count += 1;
      }
      variance[c] = count > 0 ? sum / count : 0;
      words += fmt::format("{}sd {}{} in {}", words.empty() ? "" : ", ",
                           significant(model.channels[c].from_si(std::sqrt(variance[c])), 3),
                           model.channels[c].unit ? " [" + model.channels[c].unit_text() + "]" : "", model.channels[c].name);
    }
    std::vector<double> sd;
    for (double const v : variance) sd.push_back(std::sqrt(v));
    double const floor = target.distance(static_cast<int>(lead)).floor(sd);
    if (!std::isfinite(floor)) return;
    selection.floor = floor;
    selection.floor_words = fmt::format("{} noise, {}", stated ? "the stated" : "the fitted", words);
    if (selection.result.threshold > far_above_floor * floor)
      findings.push_back({Severity::warning, "threshold_above_noise",
                          fmt::format("the final threshold {} is {:.1f} times what {} leaves of the distance, {}",
                                      significant(selection.result.threshold, 4), selection.result.threshold / floor,
                                      selection.floor_words, significant(floor, 4)),
                          "models that differ by less than that are not told apart: stop at a smaller change of the threshold, or "
                          "none of the models is the right one"});
  }

  Settings polish_settings() const {
    Settings settings(mh::settings());
    std::int64_t const samples = what_.settings.integer("polish_samples");
    settings.set("samples", samples);
    settings.set("burn_in", samples / 5);
    settings.set("thin", std::max<std::int64_t>(1, samples / 2500));
    return settings;
  }

  /// Chains on the exact likelihood, from the modes that the particles lead to.
  void polish(std::vector<std::vector<Mode>> const& modes, SelectionReport& selection, Findings& findings) {
    selection.polished.resize(candidates_.size());
    selection.polished_draws.resize(candidates_.size());
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      SelectedModel const& model = selection.result.models[k];
      if (model.probability < worth_polishing || modes[k].empty()) continue;
      auto const target = likelihood_target(k);
      Ledger extra;
      RunContext context{seed_, session_.progress, extra, [this] { return session_.interrupted(); }, {}, 60, {}, modes[k], {}};
      FitResult chains = mh::run(*target, polish_settings(), context);
      if (chains.failure || chains.interrupted || chains.draws.total() == 0) {
        findings.push_back({Severity::warning, "not_polished",
                            fmt::format("`{}` was not polished: {}", model.name,
                                        chains.failure ? chains.failure->message : std::string("the run was interrupted")),
                            ""});
        continue;
      }
      selection.polished[k] = summarise(chains);
      selection.polished_draws[k] = std::move(chains.draws);
      for (Finding finding : chains.findings) {
        if (finding.severity == Severity::note) continue;
        finding.message = fmt::format("polishing `{}`: {}", model.name, finding.message);
        findings.push_back(std::move(finding));
      }
    }
  }

  // --- checks
  // -------------------------------------------------------------------------------------------------------------------

  /// Particles of the leading model once more with a finer solver: their distances must not be those of the integrator.
  void check_solver(SelectionReport const& selection, Findings& findings) const {
    auto const lead = static_cast<std::size_t>(selection.leader());
    if (!candidates_[lead].compiled->model.integrated()) return;
    SelectedModel const& model = selection.result.models[lead];
    int const count = std::min<int>(100, static_cast<int>(model.distance.size()));
    ModelSelectionTarget const finer = make_target(true);
    std::vector<double> distance(static_cast<std::size_t>(count)), shift;
    std::vector<Simulated> ending(static_cast<std::size_t>(count));
    SelectionTarget::Batch const batch{static_cast<int>(lead), model.theta.view().columns(0, count), distance, ending};
    finer.distances({&batch, 1}, std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < distance.size(); ++i) shift.push_back(std::abs(distance[i] - model.distance[i]));
    std::nth_element(shift.begin(), shift.begin() + count / 2, shift.end());
    double const median = shift[static_cast<std::size_t>(count / 2)];
    if (!(median <= tolerable_shift * selection.result.threshold))
      findings.push_back({Severity::warning, "step_not_settled",
                          fmt::format("with {} distances move by {:.2g} of the threshold: part of them is the integrator's",
                                      candidates_[lead].fit->solver.finer_words(), median / selection.result.threshold),
                          "take a finer solver, `substeps = 4` or `solver = dopri5`"});
  }

  // --- the end
  // --------------------------------------------------------------------------------------------------------------------

  /// Parameters that mean the same in all models, over the particles of all of them.
  std::vector<WeightedSummary> shared(SelectionResult const& result) const {
    std::vector<WeightedSummary> summaries;
    for (std::string const& name : set_.shared) {
      std::vector<double> values, weights;
      std::string unit;
      double total = 0;
      for (SelectedModel const& model : result.models) {
        if (model.died_in > 0) continue;
        for (std::size_t d = 0; d < model.parameters.size(); ++d) {
          if (model.parameters[d].name != name) continue;
          unit = model.parameters[d].unit;
          for (std::size_t j = 0; j < model.weight.size(); ++j) {
            values.push_back(model.declared(static_cast<int>(d), static_cast<int>(j)));
            weights.push_back(model.weight[j] * model.probability);
            total += weights.back();
          }
        }
      }
      for (double& w : weights) w /= total;
      if (total > 0) summaries.push_back(summarise_weighted(name, unit, values, weights));
    }
    return summaries;
  }

  /// Bands of the leading model's particles over the fitted rows.
  void add_predictions(SelectionReport const& selection, Report& report) const {
    auto const lead = static_cast<std::size_t>(selection.leader());
    Candidate const& candidate = candidates_[lead];
    LaneArray const values = leading_values(selection);
    for (std::size_t e = 0; e < candidate.data.size(); ++e) {
      Experiment const& experiment = candidate.data[e].experiment;
      LaneArray parameters(static_cast<int>(candidate.compiled->model.parameters.size()), values.width());
      candidate.simulated->select(values, static_cast<int>(e), parameters);
      Trajectory const trajectory(candidate.compiled, experiment, candidate.fit->solver, start_rows(candidate.fit->start),
                                  session_.options.execution);
      Trajectory::Result result = trajectory.run(parameters, prediction_noise(seed_, static_cast<int>(e)));
      if (candidate.space->dimension() != candidate.simulated->dimension())
        std::fill(result.noisy.begin(), result.noisy.end(), std::vector<std::vector<double>>());  // the noise has no particles
      report.predictions.push_back(bands_along(trajectory, result, experiment, candidate.compiled->model));
      for (Finding& finding : band_findings(report.predictions.back(), result.failed(), result.failed(), candidate.data.size() > 1))
        report.findings.push_back(std::move(finding));
    }
  }

  LaneArray leading_values(SelectionReport const& selection) const {
    auto const lead = static_cast<std::size_t>(selection.leader());
    return candidates_[lead].simulated->values_of_declared(spread(resampled_draws(selection.result.models[lead], seed_), 100));
  }

  ExitCode finish(ModelSelectionTarget const& target, SelectionResult result) {
    bool const interrupted = result.interrupted;
    Candidate const& first = candidates_.front();
    SelectionReport selection;
    selection.result = std::move(result);
    selection.distance = what_.distance.text.empty() ? "nmse" : what_.distance.text;
    selection.likelihoods.resize(candidates_.size());
    selection.resampling_seed = seed_;
    selection.shared = shared(selection.result);
    Candidate const& leading = candidates_[static_cast<std::size_t>(selection.leader())];
    Report report = begin_report(
        session_, task_, leading.fit->model,
        fmt::format("select {} to {} with {}", set_.name, data_names(session_.file, first.fit->experiments), what_.backend), seed_);
    for (ExperimentData const& each : first.data) report.data.push_back(describe_data(session_.file, each, first.compiled->model));
    report.priors = priors_of(*leading.space, report.priors);
    report.findings = selection.result.findings;
    bool const checked = !interrupted && what_.settings.flag("cross_check"),
               polished = !interrupted && what_.settings.flag("polish");
    std::vector<std::vector<Mode>> modes;
    if (checked || polished) modes = find_modes(selection.result);
    if (checked) add_likelihoods(modes, selection, report.findings);
    if (!interrupted) {
      add_floor(target, modes, selection, report.findings);
      check_solver(selection, report.findings);
    }
    if (polished) polish(modes, selection, report.findings);
    if (interrupted)
      report.findings.push_back({Severity::warning, "interrupted", "the run was interrupted: this is its last whole population",
                                 "go on with --resume; it ends with the bytes of an unbroken run"});
    report.findings.push_back({Severity::note, "width_of_threshold",
                               "the sd of particles is the width that the threshold leaves, not that of the posterior: larger "
                               "after an early stop, smaller "
                               "after a late one",
                               polished ? "" : "`polish = yes` goes on with the likelihood and prints both"});
    if (!interrupted) add_predictions(selection, report);
    report.settings = {{"backend", what_.backend}};
    for (auto const& [name, value] : selection.result.settings.all()) report.settings.emplace_back(name, value);
    report.settings.emplace_back("distance", selection.distance);
    report.settings.emplace_back("start_state", start_text(first.fit->start));
    if (first.compiled->model.integrated()) add_solver(first.fit->solver, report.settings);
    report.resolved_text = resolved_select(session_, task_, what_, seed_);
    report.ledger = ledger_;
    report.tables = selection_tables(selection);
    report.verdict = headline(selection, report.findings);
    std::chrono::duration<double> const wall = std::chrono::steady_clock::now() - began_;
    report.timing = {{"wall_seconds", wall.count()},
                     {"threads", static_cast<std::int64_t>(session_.threads())},
                     {"lanes", static_cast<std::int64_t>(session_.options.execution.lanes)}};
    std::vector<SelectedCandidate>& kept = session_.selected[index_];
    kept.clear();
    for (SelectedModel const& model : selection.result.models)
      kept.push_back({model.probability, model.died_in > 0 ? Draws{} : resampled_draws(model, seed_)});
    report.selection = std::move(selection);
    write_result(report, session_.result_folder(task_), session_.options.figures);
    session_.out << terminal_summary(report);
    if (interrupted) {
      session_.notices << fmt::format("{}: interrupted; go on with --resume\n", task_.name);
      return ExitCode::interrupted;
    }
    remove_file(checkpoint_.path());
    return judge(report.findings).pass ? ExitCode::success : ExitCode::doubtful;
  }

  static std::string headline(SelectionReport const& selection, Findings const& findings) {
    SelectedModel const& best = selection.result.models[static_cast<std::size_t>(selection.leader())];
    std::string const floor = selection.floor ? fmt::format(", noise floor {}", significant(*selection.floor, 4)) : "";
    return fmt::format("`{}` has probability {:.3f} at threshold {}{}; {}", best.name, best.probability,
                       significant(selection.result.threshold, 4), floor,
                       judge(findings).text.substr(0, judge(findings).text.find('\n')));
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
};

}  // namespace

ExitCode run_select(Session& session, int index, Task const& task, SelectTask const& what) {
  return Select(session, index, task, what).run();
}

}  // namespace sysid
