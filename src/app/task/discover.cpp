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
#include "core/system/interrupt.hpp"
#include "core/text/number.hpp"
#include "diagnostics/verdict.hpp"
#include "discovery/difference_forecast.hpp"
#include "discovery/discovery_findings.hpp"
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
#include "load/load.hpp"
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
    std::vector<double> squares(dictionary_.measured.channels.size()), counts(squares.size());
    for (Experiment& each : records_) {
      if (unequal_step(each.time) == 0) continue;
      interpolated_.push_back(each.name);
      for (std::size_t c = 0; c < squares.size(); ++c)
        if (auto const noise = noise_at_unequal_steps(each.time, each.measured[c])) squares[c] += *noise * *noise, ++counts[c];
      each = at_equal_steps(each);
    }
    for (std::size_t c = 0; c < squares.size(); ++c)
      if (counts[c] > 0) dictionary_.numbers.channels[c].noise_sd = std::sqrt(squares[c] / counts[c]);
  }

  Findings interpolation_findings(std::optional<Validation> const& validation) const {
    bool const simulated = validation && validation->report.structures.front().failure.empty();
    Findings findings;
    for (std::string const& name : interpolated_)
      findings.push_back(
          {FindingCode::steps_interpolated,
           simulated ? Severity::note : Severity::warning,
           {name},
           fmt::format("the time steps of `{}` are unequal: the regression uses the record interpolated to equal steps{}", name,
                       simulated ? ", the simulation uses the samples at their own times" : ""),
           fmt::format("{}if it was sampled regularly, write `step` or `rate` in place of `time` in the data block",
                       simulated ? "" : "take the coefficients and sds as approximate; ")});
    return findings;
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
    add_findings(found, discovery.equations, validation ? &*validation : nullptr, report.findings);
    say_once(report.findings);
    for (Finding& each : interpolation_findings(validation)) report.findings.push_back(std::move(each));
    if (dictionary_.numbers.discrete && !structures.empty()) add_forecasts(found, discovery, report.findings);
    if (validation) {
      temper_by_simulation(validation->report, report.findings);
      report.findings.insert(report.findings.end(), validation->findings.begin(), validation->findings.end());
      discovery.answer = verdict_clauses(validation->report);
      discovery.validation = std::move(validation->report);
      discovery.free_runs = std::move(validation->free_runs);
    }
    report.equations = equations(discovery);
    if (!what_.candidates && !structures.empty()) structures.resize(1);
    FoundSource as_simulated = source;
    as_simulated.noise_sd = simulated_noise(discovery);
    add_source(as_simulated, structures, discovery, report.findings);
    add_prior_findings(discovery, report.findings);
    report.findings = merged(report.findings);
    report.tables = discovery_tables(discovery);
    report.settings = {{"selector", what_.selector}};
    for (auto const& [name, value] : what_.selector_settings.all()) report.settings.emplace_back(name, value);
    if (!dictionary_.numbers.discrete) report.settings.emplace_back("derivatives", what_.form);
    for (auto const& [name, value] : what_.form_settings.all()) report.settings.emplace_back(name, value);
    report.resolved_text = resolved_discover(session_, task_, what_, seed_);
    std::chrono::duration<double> const wall = std::chrono::steady_clock::now() - began_;
    report.timing.emplace_back("wall_seconds", wall.count());
    report.verdict = headline(discovery, report.equations, report.findings);
    if (!discovery.source.empty()) discovery.source = with_verdict(discovery.source, report.verdict, report.findings);
    report.discovery = std::move(discovery);
    keep_result(session_, task_, report);
    if (!report.discovery->source.empty())
      session_.notices << fmt::format("{}: the model that was found is `{}`\n", task_.name,
                                      (session_.result_folder(task_) / "found.sysid").string());
    return verdict_of(report.findings).pass ? ExitCode::success : ExitCode::doubtful;
  }

  // Per channel of the dictionary, SI; 0 where nothing was simulated.
  std::vector<double> simulated_noise(DiscoveryReport const& discovery) const {
    std::vector<double> noise(dictionary_.measured.channels.size());
    if (!discovery.validation || !discovery.validation->structures.front().failure.empty()) return noise;
    for (ValidatedChannel const& each : discovery.validation->structures.front().channels)
      for (std::size_t c = 0; c < noise.size(); ++c)
        if (Channel const& channel = dictionary_.measured.channels[c]; channel.name == each.channel)
          noise[c] = channel.to_si(each.residual);
    return noise;
  }

  // The fit is by the likelihood alone, so a prior may be far away.
  void add_prior_findings(DiscoveryReport const& discovery, Findings& findings) const {
    if (!discovery.validation) return;
    for (ValidatedCoefficient const& each : discovery.validation->structures.front().coefficients)
      for (InnerParameter const& inner : dictionary_.inner) {
        if (!each.inside || inner.quantity.name != each.name) continue;
        constexpr int draws = 1023;
        std::vector<double> const prior = sorted_draws(inner, draws);
        double const value = inner.quantity.to_si(each.value);
        if (value >= prior.front() && value <= prior.back()) continue;
        findings.push_back(
            {FindingCode::prior_contradicted,
             Severity::warning,
             {each.name},
             fmt::format("the record gives {} = {}{}, outside the range of {} draws of its prior ({} to {})", each.name,
                         significant(each.value, 3), unit_after_number(each.unit), draws,
                         significant(inner.quantity.from_si(prior.front()), 3),
                         significant(inner.quantity.from_si(prior.back()), 3)),
             "check the prior and its unit; if they are right, a term is missing. The fit in `found.sysid` includes the prior"});
      }
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

  // By simulation where that has validated a structure.
  static std::vector<std::string> equations(DiscoveryReport const& discovery) {
    if (discovery.validation && discovery.validation->structures.front().failure.empty())
      return discovery.validation->structures.front().equations;
    std::vector<std::string> all;
    for (DiscoveredEquation const& each : discovery.equations)
      if (!each.equation.empty()) all.push_back(each.equation);
    return all;
  }

  static std::string headline(DiscoveryReport const& discovery, std::vector<std::string> const& equations,
                              Findings const& findings) {
    std::string terms = fmt::format("{}", fmt::join(equations, "; "));
    for (DiscoveredEquation const& each : discovery.equations)
      if (each.equation.empty()) terms += fmt::format("{}{}: no equation found", terms.empty() ? "" : "; ", each.target);
    if (discovery.validation && discovery.validation->structures.front().failure.empty()) {
      for (ValidatedCoefficient const& each : discovery.validation->structures.front().coefficients)
        if (each.inside) terms += fmt::format("; {} = {}{}", each.name, significant(each.value, 4), unit_after_number(each.unit));
    } else {
      for (DiscoveryReport::Inner const& each : discovery.inner)
        terms += fmt::format("; {} = {}{}", each.name, significant(each.value, 4), unit_after_number(each.unit));
    }
    return fmt::format("{}; {}{}{}", terms, discovery.answer, discovery.answer.empty() ? "" : "; ", verdict_of(findings).headline);
  }

  // A channel at rest is a channel that is constant.
  void say_once(Findings& findings) const {
    if (std::none_of(findings.begin(), findings.end(),
                     [](Finding const& each) { return each.code == FindingCode::record_at_rest; }))
      return;
    std::erase_if(findings, [&](Finding const& each) {
      return each.code == FindingCode::column_constant &&
             std::any_of(dictionary_.measured.channels.begin(), dictionary_.measured.channels.end(),
                         [&](Channel const& channel) { return channel.name == each.names.front(); });
    });
  }

  void add_findings(regression::Discovery const& found, std::vector<DiscoveredEquation> const& described,
                    Validation const* validation, Findings& findings) const {
    for (std::size_t e = 0; e < found.equations.size(); ++e) {
      regression::FoundEquation const& equation = found.equations[e];
      for (regression::Concern const& concern : equation.concerns) {
        std::vector<std::string> names;
        for (int const term : concern.terms) names.push_back(dictionary_.equations[e].terms[static_cast<std::size_t>(term)].text);
        Finding finding = finding_of(concern, found.equations.size() > 1 ? equation.name : "", std::move(names));
        if (concern.input >= 0) {
          std::string const& input = dictionary_.measured.inputs[static_cast<std::size_t>(concern.input)].name;
          finding.names = {input};
          if (concern.kind == regression::Concern::Kind::other_rule) finding.names.emplace_back(rule_name(concern.rule));
          finding.message = fmt::format("input {}: {}", input, finding.message);
        }
        if (validation != nullptr)
          temper_by_form(validation->report, concern, validation->order.front().equations[e]->terms, finding);
        else
          temper_by_terms(concern, equation.chosen.terms, finding);
        if (std::find(findings.begin(), findings.end(), finding) == findings.end()) findings.push_back(std::move(finding));
      }
      if (validation == nullptr)
        for (Finding& each : undecided_terms(equation, described[e])) findings.push_back(std::move(each));
    }
  }

  // Written are structures that the program takes, one after the other: one may be no model that can be simulated.
  void add_source(FoundSource const& source, std::vector<FoundStructure> const& structures, DiscoveryReport& discovery,
                  Findings& findings) const {
    std::vector<FoundStructure> written;
    std::vector<std::string> excluded, names;
    for (FoundStructure const& each : structures) {
      written.push_back(each);
      std::string text = source.text(written);
      Source read((session_.result_folder(task_) / "found.sysid").string(), text);
      Diagnostics diagnostics;
      if (load(read, diagnostics)) {
        discovery.source = std::move(text);
        continue;
      }
      written.pop_back();
      names.push_back(structure_text(dictionary_, each));
      excluded.push_back(fmt::format("`{}` ({})", names.back(), diagnostics.all().front().message));
    }
    if (excluded.empty()) return;
    std::string const help = "a model needs as many equations as states, each with a derivative in it";
    if (written.empty())
      findings.push_back({FindingCode::equation_no_model, Severity::warning, std::move(names),
                          "the equation that was found is not a model that can be simulated: " + excluded.front(), help});
    else
      findings.push_back({FindingCode::candidates_left_out, Severity::warning, std::move(names),
                          fmt::format("`found.sysid` contains {} of {} structures; the others cannot be simulated: {}",
                                      written.size(), structures.size(), fmt::join(excluded, ", ")),
                          help});
  }

  Session& session_;
  Task const& task_;
  DiscoverTask const& what_;
  std::vector<Experiment> records_;        // as the regression reads them
  std::vector<std::string> interpolated_;  // names of those that were
  std::vector<double> inner_, inner_sd_;   // values of the parameters inside terms, SI
  CheckedDictionary dictionary_;           // with the values that were found for parameters inside terms
  std::uint64_t seed_;
  std::chrono::steady_clock::time_point began_;
  std::vector<ExperimentData> data_;
};

}  // namespace

ExitCode run_discover(Session& session, Task const& task, DiscoverTask const& what) { return Discover(session, task, what).run(); }

}  // namespace sysid
