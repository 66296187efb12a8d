// Every fit simulates as many trajectories as the task asks for, whatever its weight: these weigh the draws.
#include "app/average/predict_average.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "app/average/average_tables.hpp"
#include "app/average/member_doubt.hpp"
#include "app/average/member_weights.hpp"
#include "app/average/mixture_bands.hpp"
#include "app/comparison/compare.hpp"
#include "app/session/made_from.hpp"
#include "app/session/provenance.hpp"
#include "app/session/reporting.hpp"
#include "app/session/solver_record.hpp"
#include "app/session/stored_draws.hpp"
#include "app/session/task_rows.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/system/interrupt.hpp"
#include "data/start_rule.hpp"
#include "diagnostics/bands.hpp"
#include "diagnostics/coverage.hpp"
#include "diagnostics/scores.hpp"
#include "diagnostics/verdict.hpp"
#include "experiment/experiments.hpp"
#include "experiment/fitted_rows.hpp"

namespace sysid {
namespace {

/// The draws of the first member are those of its prediction alone; the others have streams of their own.
std::uint64_t seed_of(std::uint64_t seed, std::size_t member) {
  return member == 0 ? seed : Stream({seed, Purpose::average, member, 0}).bits();
}

/// The same record with the samples that all score, which others may be compared on. scored: of what rows of `along` each channel.
ExperimentData with_samples(ExperimentData data, Model const& model, Experiment const& along,
                            std::vector<ScoredChannel> const& scored) {
  Experiment& experiment = data.experiment;
  int const skipped = along.first_row - experiment.first_row;
  std::vector<std::uint8_t> any(experiment.scored.size(), 0);
  for (std::size_t c = 0; c < model.channels.size(); ++c) {
    auto const found =
        std::ranges::find_if(scored, [&](ScoredChannel const& each) { return each.scores.channel == model.channels[c].name; });
    for (std::size_t i = 0; i < experiment.measured[c].size(); ++i) {
      auto const row = static_cast<std::size_t>(static_cast<int>(i) - skipped);  // large where it is before the first
      bool const all = found != scored.end() && row < found->rows.size() && found->rows[row] != 0;
      if (all)
        any[i] = 1;
      else
        experiment.measured[c][i] = not_a_number;
    }
  }
  experiment.scored = std::move(any);
  return data;
}

class PredictAverage {
 public:
  PredictAverage(Session& session, Task const& task, PredictTask const& what)
      : session_(session),
        task_(task),
        what_(what),
        seed_(session.seed(task, what.seed)),
        weighed_(weigh_members(session, task, what)) {
    for (std::size_t k = 0; k < what.members.size(); ++k) {
      members_.push_back(std::make_unique<PosteriorTrajectories>(session, what.members[k], seed_of(seed_, k)));
      AveragedMember& member = weighed_.members[k];
      member.draws = members_[k]->wanted();
      member.model = members_[k]->model().name;
      weights_.push_back(member.weight);
    }
    lead_ = static_cast<std::size_t>(std::ranges::max_element(weights_) - weights_.begin());
  }

  ExitCode run() {
    Model const& model = members_[lead_]->model();
    Report report = begin_report(session_, task_, fit(lead_).model, what_text(), seed_);
    add_predicted_rule(model, what_.prediction, report);
    report.findings = weighed_.findings;
    add_kinds(report);
    report.average = AverageReport{what_.weights, weighed_.members, {}, {}};
    for (std::size_t k = 0; k < members_.size(); ++k) add_optimum(k, report);
    for (int e = 0; e < static_cast<int>(members_[lead_]->data().size()); ++e) predict(e, report);
    for (std::size_t k = 0; k < members_.size(); ++k) {
      std::size_t const before = report.findings.size();
      add_source(session_.result_folder(session_.file.tasks[static_cast<std::size_t>(what_.members[k].fit)]), report);
      for (std::size_t f = before; f < report.findings.size(); ++f) {
        Severity& severity = report.findings[f].severity;
        // A fit that counts with another has no part in anything.
        severity = weighed_.members[k].counted.empty() ? doubt_of_member(severity, weights_[k]) : Severity::note;
      }
    }
    report.settings = {{"draws", static_cast<std::int64_t>(what_.draws)},
                       {"weights", std::string(word(what_.weights))},
                       {"start", start_text(what_.start)}};
    if (model.integrated()) add_solver(members_[lead_]->solver(), report.settings);
    if (std::string const predicted = predicted_text(model, what_.prediction); !predicted.empty())
      report.settings.emplace_back("prediction", two_kinds() ? "of each model" : predicted);
    add_average_tables(*report.average, weighed_.notes, report.tables);
    bool const missed = add_coverage(report, model.dynamics == Dynamics::discrete && !model.states.empty());
    report.verdict = prediction_verdict(report, missed);
    keep_result(session_, task_, report);
    return grade(report) == Severity::error ? ExitCode::doubtful : ExitCode::success;
  }

 private:
  FitTask const& fit(std::size_t k) const {
    return std::get<FitTask>(session_.file.tasks[static_cast<std::size_t>(what_.members[k].fit)].what);
  }
  std::string const& name(std::size_t k) const { return weighed_.members[k].fit; }

  std::string what_text() const {
    std::string const predicted = two_kinds() ? std::string() : predicted_text(members_[lead_]->model(), what_.prediction);
    return fmt::format("predict {} on {} with draws({}), weights = {}{}", predicted_names(session_.file, what_),
                       data_names(session_.file, what_.experiments), what_.draws, word(what_.weights),
                       predicted.empty() ? std::string() : fmt::format(" ({})", predicted));
  }

  /// Names of the members that predict one step from measured samples, or that run freely.
  std::vector<std::string> of_kind(bool one_step) const {
    std::vector<std::string> names;
    for (std::size_t k = 0; k < members_.size(); ++k)
      if (weights_[k] > 0 && predicts_from_data(members_[k]->model()) == one_step) names.push_back("`" + name(k) + "`");
    return names;
  }
  bool two_kinds() const {
    return members_[lead_]->model().dynamics == Dynamics::discrete && !of_kind(true).empty() && !of_kind(false).empty();
  }

  /// Their scores say different things.
  void add_kinds(Report& report) const {
    if (!two_kinds()) return;
    report.prediction_rule = mixed_kinds;
    report.findings.push_back(
        {FindingCode::averaged_over_models,
         Severity::note,
         {},
         fmt::format("predictions of two kinds are averaged: {} from measured past samples, {} in free run",
                     fmt::join(of_kind(true), ", "), fmt::join(of_kind(false), ", ")),
         "to compare models, predict with all of them in the same way: `prediction = one_step` or `free_run`"});
  }

  void add_optimum(std::size_t k, Report& report) const {
    if (members_[k]->fitted().draws.total() != 1) return;
    report.findings.push_back(
        {FindingCode::optimum_alone,
         Severity::note,
         {name(k)},
         fmt::format("`{}` gives an optimum, not a posterior: its part of the bands does not include the uncertainty of its "
                     "parameters",
                     name(k)),
         "fit with mh for bands that include it"});
  }

  /// Adds bands, scores, findings and failures of experiment e.
  void predict(int e, Report& report) const {
    std::vector<MemberAlong> along;
    for (std::size_t k = 0; k < members_.size(); ++k) {
      stop_if_interrupted();
      along.push_back(run_along(session_, *members_[k], e, members_[lead_]->model()));
      add_findings(k, e, along.back(), report);
      if (weights_[k] > 0) report.ledger.merge(along.back().ledger);
    }
    cut_to_common_rows(along);
    Model const& model = members_[lead_]->model();
    ExperimentData const& data = members_[lead_]->data()[static_cast<std::size_t>(e)];
    Experiment const& experiment = along[lead_].experiment;
    Prediction average = record_along(experiment, model);
    std::vector<AveragedBand> bands = averaged_bands(along, weights_, lead_);
    for (std::size_t c = 0; c < model.channels.size(); ++c) {
      auto const band = std::ranges::find_if(bands, [&](auto const& each) { return each.average.name == model.channels[c].name; });
      if (band == bands.end() && !experiment.measured[c].empty())
        throw std::logic_error("a measured channel of an average is not of all its fits");
      if (band == bands.end()) continue;
      for (double const si : experiment.measured[c]) band->average.measured.push_back(model.channels[c].from_si(si));
    }
    std::vector<ScoredChannel> scored = averaged_scores(along, weights_, average.experiment, bands);
    add_data(session_.file, with_samples(data, model, experiment, scored), model, report);
    if (!scored.empty()) std::ranges::fill(average.scored, std::uint8_t{0});
    for (ScoredChannel& channel : scored) {
      for (std::size_t i = 0; i < channel.rows.size(); ++i) average.scored[i] |= channel.rows[i];
      auto const of = std::ranges::find_if(bands, [&](auto const& each) { return each.average.name == channel.scores.channel; });
      std::vector<Score> all = scores(of->average, channel.rows);
      all.insert(all.begin(), {{ScoreKind::log_score}, channel.scores.average.log_score});
      report.fit.push_back({channel.scores.experiment, channel.scores.channel, channel.scores.unit, std::move(all)});
      report.average->channels.push_back(std::move(channel.scores));
    }
    for (std::size_t k = 0; k < along.size(); ++k)
      add_left_out(k, static_cast<int>(along[k].ledger.failed()), average, bands, report);
    for (AveragedBand& band : bands) average.quantities.push_back(std::move(band.average));
    for (VarianceShares& shares : variance_shares(average)) report.average->shares.push_back(std::move(shares));
    report.predictions.push_back(std::move(average));
  }

  /// Trajectories of member k that are left out of bands, and rows that it cannot predict.
  void add_left_out(std::size_t k, int failed, Prediction const& along, std::vector<AveragedBand> const& bands,
                    Report& report) const {
    Prediction alone;
    alone.experiment = along.experiment;
    for (AveragedBand const& band : bands) {
      PredictedQuantity const& own = band.members[k].band;
      PredictedQuantity& counts = alone.quantities.emplace_back();
      counts.name = own.name;
      counts.measured = band.average.measured;
      counts.response.draws = own.response.draws;
      counts.response.excluded = own.response.excluded;
      counts.noisy.draws = own.noisy.draws;
      counts.noisy.excluded = own.noisy.excluded;
    }
    for (Finding& finding : band_findings(alone, failed, failed, several())) add_of_member(k, std::move(finding), report);
    for (AveragedBand const& band : bands) {
      int const undefined = band.members[k].undefined;
      if (undefined == 0) continue;
      auto const rows = static_cast<std::uint64_t>(along.time.size());
      Severity severity = failure_severity(static_cast<std::uint64_t>(undefined), rows);
      if (band.average.measured.empty()) severity = std::max(severity, Severity::warning);
      add_of_member(k,
                    {FindingCode::undefined_in_band,
                     severity,
                     {band.average.name, along.experiment},
                     fmt::format("{}{} is undefined along every trajectory at {} of {} rows; {}", band.average.name,
                                 several() ? " on " + along.experiment : std::string(), undefined, rows,
                                 weights_[k] < negligible_weight ? "the average there is that of the other fits"
                                                                 : "the average has no value there"),
                     "check for a root or a logarithm of a negative number, or a division by zero"},
                    report);
    }
  }

  /// A finding of member k alone, with its name, weighed.
  void add_of_member(std::size_t k, Finding finding, Report& report) const {
    finding.message = fmt::format("with `{}`: {}", name(k), finding.message);
    finding.names.push_back(name(k));
    if (Severity const severity = doubt_of_trajectories(finding.severity, weights_[k]);
        row_of(finding.code).severities.contains(severity))
      finding.severity = severity;
    report.findings.push_back(std::move(finding));
  }

  bool several() const { return members_[lead_]->data().size() > 1; }

  /// What a prediction with member k alone would find, with its name.
  void add_findings(std::size_t k, int e, MemberAlong const& along, Report& report) const {
    ExperimentData const& data = members_[k]->data()[static_cast<std::size_t>(e)];
    auto const add = [&](Finding finding) { add_of_member(k, std::move(finding), report); };
    if (auto const drawn = members_[k]->drawn_from_prior(e); !drawn.empty())
      add({FindingCode::new_experiment,
           Severity::note,
           {data.use.name},
           fmt::format("`{}` was not fitted: {} {} drawn from the prior given the shared parameters", data.use.name,
                       fmt::join(drawn, ", "), drawn.size() == 1 ? "is" : "are"),
           ""});
    for (Finding const& each : along.findings) add(each);
    if (int const failed = along.ledger.failed(); failed > 0)
      add({FindingCode::failed_predictions,
           failure_severity(along.ledger.failed(), along.ledger.solves()),
           {data.experiment.name},
           fmt::format("{} of {} trajectories{} do not stay finite and are left out of the bands", failed, members_[k]->wanted(),
                       several() ? " on " + data.experiment.name : ""),
           "the model diverges on this input at some draws: narrow the priors, or check the equation"});
    for (Finding& finding : find_fitted_rows(session_.file, session_.folder(), data, fit(k).experiments, name(k)))
      report.findings.push_back(std::move(finding));
  }

  Session& session_;
  Task const& task_;
  PredictTask const& what_;
  std::uint64_t seed_;
  MemberWeights weighed_;
  std::vector<std::unique_ptr<PosteriorTrajectories>> members_;
  std::vector<double> weights_;
  std::size_t lead_ = 0;
};

}  // namespace

ExitCode run_predict_average(Session& session, Task const& task, PredictTask const& what) {
  return PredictAverage(session, task, what).run();
}

}  // namespace sysid
