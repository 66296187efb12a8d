// Every fit simulates as many trajectories as the task asks for, whatever its weight: these weigh the draws.
#include "app/average/predict_average.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "app/average/average_tables.hpp"
#include "app/average/member_weights.hpp"
#include "app/average/mixture_bands.hpp"
#include "app/session/made_from.hpp"
#include "app/session/provenance.hpp"
#include "app/session/reporting.hpp"
#include "app/session/solver_record.hpp"
#include "app/session/stored_draws.hpp"
#include "app/session/task_rows.hpp"
#include "core/system/interrupt.hpp"
#include "data/start_rule.hpp"
#include "diagnostics/bands.hpp"
#include "diagnostics/coverage.hpp"
#include "diagnostics/verdict.hpp"
#include "experiment/experiments.hpp"
#include "experiment/fitted_rows.hpp"

namespace sysid {
namespace {

/// The draws of the first member are those of its prediction alone; the others have streams of their own.
std::uint64_t seed_of(std::uint64_t seed, std::size_t member) {
  return member == 0 ? seed : Stream({seed, Purpose::average, member, 0}).bits();
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
    add_prediction_rule(model, what_.prediction, report);
    report.findings = weighed_.findings;
    report.average = AverageReport{what_.weights, weighed_.members, {}, {}};
    for (std::size_t k = 0; k < members_.size(); ++k) add_optimum(k, report);
    for (int e = 0; e < static_cast<int>(members_[lead_]->data().size()); ++e) predict(e, report);
    for (PredictTask const& member : what_.members)
      add_source(session_.result_folder(session_.file.tasks[static_cast<std::size_t>(member.fit)]), report);
    report.settings = {{"draws", static_cast<std::int64_t>(what_.draws)},
                       {"weights", std::string(word(what_.weights))},
                       {"start", start_text(what_.start)}};
    if (model.integrated()) add_solver(members_[lead_]->fitted().solver, report.settings);
    if (model.dynamics == Dynamics::discrete) report.settings.emplace_back("prediction", prediction_text(model, what_.prediction));
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
    Model const& model = members_[lead_]->model();
    return fmt::format(
        "predict {} on {} with draws({}), weights = {}{}", predicted_names(session_.file, what_),
        data_names(session_.file, what_.experiments), what_.draws, word(what_.weights),
        model.dynamics == Dynamics::discrete ? fmt::format(" ({})", prediction_text(model, what_.prediction)) : std::string());
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
      along.push_back(run_along(session_, *members_[k], e, members_[lead_]->model().channels));
      add_findings(k, e, along.back(), report);
      report.ledger.merge(along.back().ledger);
    }
    cut_to_common_rows(along);
    Model const& model = members_[lead_]->model();
    ExperimentData const& data = members_[lead_]->data()[static_cast<std::size_t>(e)];
    add_data(session_.file, data, model, report);
    Experiment const& experiment = along[lead_].experiment;
    Prediction average = record_along(experiment, model);
    average.quantities = averaged_quantities(along, weights_, lead_);
    for (PredictedQuantity& quantity : average.quantities)
      for (std::size_t c = 0; c < model.channels.size(); ++c)
        if (model.channels[c].name == quantity.name)
          for (double const si : experiment.measured[c]) quantity.measured.push_back(model.channels[c].from_si(si));
    for (AveragedChannel& channel : averaged_scores(along, weights_, average)) {
      report.fit.push_back({channel.experiment, channel.channel, channel.unit, {{"log_score", channel.average.log_score}}});
      report.average->channels.push_back(std::move(channel));
    }
    for (VarianceShares& shares : variance_shares(average)) report.average->shares.push_back(std::move(shares));
    int failed = 0;
    for (std::size_t k = 0; k < along.size(); ++k)
      if (weights_[k] > 0) failed += static_cast<int>(along[k].ledger.failed());
    for (Finding& finding : band_findings(average, failed, failed, several())) report.findings.push_back(std::move(finding));
    report.predictions.push_back(std::move(average));
  }

  bool several() const { return members_[lead_]->data().size() > 1; }

  /// What a prediction with member k alone would find, with its name.
  void add_findings(std::size_t k, int e, MemberAlong const& along, Report& report) const {
    ExperimentData const& data = members_[k]->data()[static_cast<std::size_t>(e)];
    auto const add = [&](Finding finding) {
      finding.message = fmt::format("with `{}`: {}", name(k), finding.message);
      finding.names.push_back(name(k));
      report.findings.push_back(std::move(finding));
    };
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
    for (Finding& finding : find_fitted_rows(session_.file, data, fit(k).experiments, name(k)))
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
