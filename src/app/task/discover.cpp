// `discover`: experiments to the regression, its answer in the words of the file, the source of what was found.
#include "app/task/tasks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <numeric>

#include "app/session/preconditions.hpp"
#include "app/session/provenance.hpp"
#include "app/session/reporting.hpp"
#include "app/session/resolved.hpp"
#include "app/session/session.hpp"
#include "app/task/described_discovery.hpp"
#include "app/task/discovery_conclusions.hpp"
#include "core/system/interrupt.hpp"
#include "diagnostics/verdict.hpp"
#include "discovery/difference_forecast.hpp"
#include "discovery/discovery_verdict.hpp"
#include "discovery/found_source.hpp"
#include "discovery/idle_terms.hpp"
#include "discovery/preparation/equal_steps.hpp"
#include "discovery/preparation/held_out_rows.hpp"
#include "discovery/preparation/inner_search.hpp"
#include "discovery/preparation/inner_spread.hpp"
#include "discovery/search/structure_search.hpp"
#include "discovery/simulation_validation.hpp"
#include "discovery/validation_findings.hpp"
#include "experiment/experiments.hpp"
#include "regression/discovery.hpp"
#include "report/file/discovery.hpp"

namespace sysid {
namespace {

/// Of parameters inside terms: so many values of all are compared by simulation.
constexpr int most_inner_modes = 4;

class Discover {
 public:
  Discover(Session& session, Task const& task, DiscoverTask const& what)
      : session_(session),
        task_(task),
        what_(what),
        dictionary_(session.file.dictionaries[static_cast<std::size_t>(what.dictionary)]),
        seed_(session.seed(task, what.seed)),
        began_(std::chrono::steady_clock::now()),
        data_(load_experiments(session, what.experiments, dictionary_.measured, {StartRule::Kind::rest, 0},
                               PredictionRule::as_written)) {}

  ExitCode run() {
    if (auto const why = refusal(task_, what_, session_.file, data_)) throw UserError(*why);
    regression::Method method;
    method.form = regression::find_form(what_.form);
    method.form_settings = what_.form_settings;
    method.selector = regression::find_selector(what_.selector);
    method.selector_settings = what_.selector_settings;
    method.seed = seed_;
    method.interrupted = [this] { return session_.interrupted(); };
    read_records();
    std::deque<Attempt> attempts = attempts_with(method);
    if (lacks_windows(attempts.front().found) && fill_records()) attempts = attempts_with(method);
    std::vector<FoundStructure> structures = best_structures(attempts.front().found, what_.top);
    std::optional<Validation> validation;
    if (what_.refit && !structures.empty() && !dictionary_.numbers.discrete) {
      validation = validated(attempts, method);
      structures = validation->order;
    }
    Attempt const& best = validation ? attempts.back() : attempts.front();
    dictionary_.numbers = best.dictionary.numbers;
    inner_ = best.inner;
    if (!validation) inner_sd_ = best.inner_sd;
    return finish(best.found, *method.selector, source_of(best), structures, validation);
  }

 private:
  /// What is found with some values of the parameters inside terms.
  struct Attempt {
    CheckedDictionary dictionary;
    std::vector<double> inner;
    regression::Discovery found;
    std::vector<double> inner_sd = {};              // where nothing refines the values; else empty, and where it is not known
    StructureSearch search = {};                    // holds supports of structures
    std::deque<regression::Support> supports = {};  // of others
  };

  Attempt attempt(std::vector<double> const& inner, regression::Method const& method) const {
    Attempt out{dictionary_, inner, {}};
    out.dictionary.numbers = with_inner(numbers(), dictionary_.open, dictionary_.inner, inner);
    out.found = regression::discover(out.dictionary.numbers, records_, method);
    if (out.found.interrupted) throw Interrupted();
    return out;
  }

  /// One, or one for each mode of the parameters inside terms, the best one first.
  std::deque<Attempt> attempts_with(regression::Method const& method) const {
    std::deque<Attempt> attempts;
    if (dictionary_.inner.empty()) {
      attempts.push_back(attempt({}, method));
      return attempts;
    }
    CheckedDictionary noisy = dictionary_;
    noisy.numbers = numbers();
    bool const final_values = !what_.refit || dictionary_.numbers.discrete;
    InnerSearch const search = search_inner(noisy, records_, method, most_inner_modes, final_values);
    if (search.interrupted) throw Interrupted();
    for (InnerSearch::Mode const& mode : search.modes) attempts.push_back(attempt(mode.values, method));
    if (final_values) {
      Attempt& first = attempts.front();
      first.inner_sd = add_inner_spread(noisy, records_, method, first.inner, first.found);
      if (session_.interrupted()) throw Interrupted();  // else it would say that they are not known
    }
    return attempts;
  }

  /// The structures that a search by simulation finds, and where it cannot search those of the regression.
  std::vector<FoundStructure> structures_of(Attempt& attempt, regression::Method const& method) const {
    std::vector<FoundStructure> listed = best_structures(attempt.found, what_.top);
    if (listed.empty()) return listed;
    attempt.search = search_structures(source_of(attempt), listed, what_.top, method.interrupted);
    if (attempt.search.searched) listed = attempt.search.structures;
    for (FoundStructure& each : listed) each.inner = attempt.inner;
    return listed;
  }

  /// Of all attempts together. Fits by simulation improve parameters inside terms: with their values all is done once more, as the
  /// last attempt.
  Validation validated(std::deque<Attempt>& attempts, regression::Method const& method) {
    std::vector<FoundStructure> structures;
    for (Attempt& each : attempts) {
      std::vector<FoundStructure> const own = structures_of(each, method);
      structures.insert(structures.end(), own.begin(), own.end());
    }
    auto const validate = [&](Attempt const& by) {
      Validation out = validate_structures(source_of(by), structures, held_out(), by.search.record, method.interrupted);
      if (out.interrupted) throw Interrupted();
      return out;
    };
    Validation first = validate(attempts.front());
    bool const any = first.report.structures.front().failure.empty();
    if (dictionary_.inner.empty()) return first;
    attempts.push_back(any ? attempt(first.order.front().inner, method) : attempts.front());
    if (!any) return first;
    structures = structures_of(attempts.back(), method);
    for (FoundStructure& each : without_idle_terms(dictionary_, first, attempts.back().supports))
      structures.push_back(std::move(each));
    for (std::size_t k = 0; k < first.order.size(); ++k)
      if (first.report.structures[k].failure.empty()) structures.push_back(first.order[k]);
    return validate(attempts.back());
  }

  FoundSource source_of(Attempt const& attempt) const {
    return {.file = session_.file,
            .folder = session_.folder(),
            .results = session_.result_folder(task_),
            .execution = session_.abandonable(),
            .task = task_,
            .what = what_,
            .dictionary = attempt.dictionary,
            .data = data_,
            .discovery = attempt.found,
            .inner = attempt.inner,
            .growth = attempt.search.record.growth,
            .seed = seed_};
  }

  /// The regression needs equal steps; simulations take the samples as they are.
  void read_records() {
    records_ = experiments_of(data_);
    if (dictionary_.numbers.discrete) return;
    std::vector<Experiment> uneven;
    for (Experiment& each : records_) {
      if (unequal_step(each.time) == 0) continue;
      interpolated_.push_back(each.name);
      uneven.push_back(each);
      each = at_equal_steps(each);
    }
    take_noise_of(uneven);
  }

  /// Before they are interpolated, which takes some of it away.
  void take_noise_of(std::vector<Experiment> const& experiments) {
    std::vector<double> squares(dictionary_.measured.channels.size()), counts(squares.size());
    for (Experiment const& each : experiments)
      for (std::size_t c = 0; c < squares.size(); ++c)
        if (auto const noise = noise_at_unequal_steps(each.time, each.measured[c])) squares[c] += *noise * *noise, ++counts[c];
    for (std::size_t c = 0; c < squares.size(); ++c)
      if (counts[c] > 0) dictionary_.numbers.channels[c].noise_sd = std::sqrt(squares[c] / counts[c]);
  }

  /// Whether missing samples leave an equation too few windows, or cost most of them.
  static bool lacks_windows(regression::Discovery const& found) {
    using Kind = regression::Concern::Kind;
    return std::ranges::any_of(found.equations, [](regression::FoundEquation const& equation) {
      bool const too_few = std::ranges::any_of(equation.concerns, [](auto const& each) { return each.kind == Kind::too_few_rows; });
      return std::ranges::any_of(equation.concerns, [&](regression::Concern const& each) {
        return each.kind == Kind::missing && (too_few || each.value > 0.5);
      });
    });
  }

  /// Missing samples that have neighbours are interpolated; returns whether there are any. Simulations take what was measured.
  bool fill_records() {
    std::vector<Experiment> filled = records_, gappy;
    for (std::size_t e = 0; e < filled.size(); ++e)
      if (fill_missing(filled[e])) {
        filled_.push_back(filled[e].name);
        gappy.push_back(records_[e]);
      }
    // That of records of unequal steps is known.
    if (interpolated_.empty()) take_noise_of(gappy);
    records_ = std::move(filled);
    return !filled_.empty();
  }

  // With the noise that the task gives.
  regression::Dictionary numbers() const {
    regression::Dictionary numbers = dictionary_.numbers;
    for (std::size_t c = 0; c < what_.noise.size(); ++c)
      if (what_.noise[c]) numbers.channels[c].noise_sd = what_.noise[c];
    return numbers;
  }

  // With the dictionary's columns, as the task's own.
  std::vector<ExperimentData> held_out() const {
    return load_experiments(session_, unused_parts(session_.file, what_, 1), dictionary_.measured, {StartRule::Kind::rest, 0},
                            PredictionRule::as_written);
  }

  ExitCode finish(regression::Discovery const& found, regression::SelectorRow const& selector, FoundSource const& source,
                  std::vector<FoundStructure> structures, std::optional<Validation>& validation) {
    Report report;
    report.version = SYSID_VERSION;
    report.task = task_.name;
    report.what = fmt::format("discover {} from {} with {}", dictionary_.name, data_names(session_.file, what_.experiments),
                              method_text(dictionary_, what_));
    report.verb = verb_of(task_);
    report.lags = data_lag(dictionary_.measured);
    report.seed = seed_;
    add_repetition(session_, task_, report);
    report.model_name = dictionary_.name;
    report.model_title = dictionary_.title;
    report.model_text = std::string(session_.source.text(dictionary_.tree.span));
    report.versions = {{"sysid", std::string(SYSID_VERSION)},
                       {"random_numbers", std::string("Philox4x64-10")},
                       {"model_sha256", task_digest(session_, task_)},
                       {"statement_sha256", statement_digest(session_, task_)}};
    add_fitted_data(session_.file, data_, dictionary_.measured, report);
    DiscoveryReport discovery = described_discovery({what_, dictionary_, inner_, inner_sd_}, found, selector);
    add_regression_findings(dictionary_, found, discovery.equations, validation ? &*validation : nullptr, report.findings);
    bool const simulated = validation && validation->report.structures.front().failure.empty();
    for (Finding& each : interpolation_findings(interpolated_, simulated)) report.findings.push_back(std::move(each));
    for (Finding& each : filling_findings(filled_, simulated)) report.findings.push_back(std::move(each));
    if (dictionary_.numbers.discrete && !structures.empty()) add_forecasts(found, discovery, report.findings);
    if (validation) {
      temper_by_simulation(validation->report, report.findings);
      report.findings.insert(report.findings.end(), validation->findings.begin(), validation->findings.end());
      discovery.answer = verdict_clauses(validation->report);
      discovery.validation = std::move(validation->report);
      discovery.free_runs = std::move(validation->free_runs);
    }
    report.equations = found_equations(discovery);
    if (!what_.candidates && !structures.empty()) structures.resize(1);
    FoundSource as_simulated = source;
    as_simulated.noise_sd = simulated_noise(dictionary_, discovery);
    add_found_source(as_simulated, structures, discovery, report.findings);
    add_prior_findings(dictionary_, discovery, report.findings);
    report.findings = merged(report.findings);
    report.tables = discovery_tables(discovery);
    report.settings = {{"selector", what_.selector}};
    for (auto const& [name, value] : what_.selector_settings.all()) report.settings.emplace_back(name, value);
    if (!dictionary_.numbers.discrete) report.settings.emplace_back("derivatives", what_.form);
    for (auto const& [name, value] : what_.form_settings.all()) report.settings.emplace_back(name, value);
    report.resolved_text = resolved_discover(session_, task_, what_, seed_);
    std::chrono::duration<double> const wall = std::chrono::steady_clock::now() - began_;
    report.timing.emplace_back("wall_seconds", wall.count());
    report.verdict = discovery_headline(discovery, report.equations, report.findings);
    if (!discovery.source.empty()) discovery.source = with_verdict(discovery.source, report.verdict, report.findings);
    report.discovery = std::move(discovery);
    keep_result(session_, task_, report);
    if (!report.discovery->source.empty())
      session_.notices << fmt::format("{}: the model that was found is `{}`\n", task_.name,
                                      (session_.result_folder(task_) / "found.sysid").string());
    return verdict_of(report.findings).pass ? ExitCode::success : ExitCode::doubtful;
  }

  // Of the chosen difference equations, on the parts of the data that were not used.
  void add_forecasts(regression::Discovery const& found, DiscoveryReport& discovery, Findings& findings) const {
    std::vector<ExperimentData> const unused = held_out();
    if (unused.empty()) return;
    for (ExperimentData const& each : unused)
      discovery.forecast_rows += (discovery.forecast_rows.empty() ? "" : ", ") + each.experiment.name;
    auto const [errors, runs] = difference_forecasts(dictionary_.numbers, found, experiments_of(unused), seed_);
    std::vector<std::size_t> channels(dictionary_.measured.channels.size());
    std::iota(channels.begin(), channels.end(), std::size_t{0});
    for (FreeMotion const& run : runs)
      discovery.free_runs.push_back(
          shown_motion(run, unused[static_cast<std::size_t>(run.experiment)].experiment, dictionary_.measured, channels));
    for (std::size_t e = 0; e < errors.size(); ++e) {
      DictionaryEquation const& equation = dictionary_.equations[e];
      double const scale = equation.unit ? equation.unit->scale : 1;
      auto const declared = [scale](std::optional<double> value) { return value ? std::optional(*value / scale) : std::nullopt; };
      discovery.forecasts.push_back({equation.text, equation.unit ? equation.unit->text : "", errors[e].sd / scale,
                                     declared(errors[e].one_step), declared(errors[e].free_run), declared(errors[e].expected)});
    }
    Findings of_forecast = forecast_findings(dictionary_, errors, discovery.forecast_rows);
    findings.insert(findings.end(), of_forecast.begin(), of_forecast.end());
  }

  Session& session_;
  Task const& task_;
  DiscoverTask const& what_;
  std::vector<Experiment> records_;        // as the regression reads them
  std::vector<std::string> interpolated_;  // names of those that were
  std::vector<std::string> filled_;        // of those that had missing samples
  std::vector<double> inner_, inner_sd_;   // values of the parameters inside terms, SI
  CheckedDictionary dictionary_;           // with the values that were found for parameters inside terms
  std::uint64_t seed_;
  std::chrono::steady_clock::time_point began_;
  std::vector<ExperimentData> data_;
};

}  // namespace

ExitCode run_discover(Session& session, Task const& task, DiscoverTask const& what) { return Discover(session, task, what).run(); }

}  // namespace sysid
