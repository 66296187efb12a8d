// `predict` of a selection: trajectories of all living candidates' particles, as many of each as it is probable.
#include "app/selection/select.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "app/selection/selection_trajectories.hpp"
#include "app/session/made_from.hpp"
#include "app/session/provenance.hpp"
#include "app/session/reporting.hpp"
#include "app/session/resolved.hpp"
#include "app/session/solver_record.hpp"
#include "core/text/diagnostic.hpp"
#include "criteria/mixture.hpp"
#include "data/start_rule.hpp"
#include "diagnostics/bands.hpp"
#include "diagnostics/function_ranges.hpp"
#include "diagnostics/scores.hpp"
#include "diagnostics/verdict.hpp"
#include "experiment/fitted_rows.hpp"
#include "inference/table.hpp"
#include "mechanics/restoring_force.hpp"

namespace sysid {
namespace {

class PredictSelection {
 public:
  PredictSelection(Session& session, Task const& task, PredictTask const& what)
      : session_(session),
        task_(task),
        what_(what),
        select_task_(session.file.tasks[static_cast<std::size_t>(what.fit)]),
        select_(std::get<SelectTask>(select_task_.what)),
        seed_(session.seed(task, what.seed)),
        trajectories_(session, what, seed_) {}

  ExitCode run() {
    if (what_.redraw_each_step)
      throw UserError({Severity::error,
                       "E6519",
                       "parameters cannot be redrawn at each step if the trajectories belong to different models",
                       Label{task_.span, {}},
                       {},
                       "remove `redraw = step`"});
    std::size_t const lead = trajectories_.lead();
    Report report = begin_report(session_, task_, select_.fits[lead].model,
                                 fmt::format("predict {} on {} with draws({})", select_task_.name,
                                             data_names(session_.file, what_.candidate_experiments[lead]), what_.draws),
                                 seed_);
    for (std::size_t e = 0; e < what_.candidate_experiments[lead].size(); ++e) predict(e, lead, report);
    add_source(session_.result_folder(select_task_), report);
    report.settings = {{"draws", static_cast<std::int64_t>(what_.draws)}, {"start", start_text(what_.start)}};
    if (session_.file.models[static_cast<std::size_t>(select_.fits[lead].model)].integrated())
      add_solver(trajectories_.solver(lead), report.settings);
    report.verdict = prediction_verdict(report, false);
    keep_result(session_, task_, report);
    return grade(report) == Severity::error ? ExitCode::doubtful : ExitCode::success;
  }

 private:
  /// Adds bands of experiment e over all candidates' trajectories, findings and failures.
  void predict(std::size_t e, std::size_t lead, Report& report) const {
    // The leading one first: its quantities are those of the bands, channels of the others are found by name.
    SelectionTrajectories::Along leading = trajectories_.along(lead, e);
    add_restoring_forces(leading.model(), leading.trajectory->quantities(), leading.result, leading.parameters,
                         leading.data->experiment, report.forces);
    add_predicted_rule(leading.model(), what_.prediction, report);
    add_data(session_.file, *leading.data, leading.model(), report);
    for (Finding& finding :
         find_fitted_rows(session_.file, session_.folder(), *leading.data, select_.fits[lead].experiments, select_task_.name))
      report.findings.push_back(std::move(finding));
    add_ranges(leading, report);
    int const leading_failed = leading.result.failed();
    Owners owners(leading.result.values.size());
    own(lead, leading.result, owners);
    std::vector<int> const& counts = trajectories_.counts();
    Trajectory::Result all = std::move(leading.result);
    for (std::size_t k = 0; k < counts.size(); ++k) {
      if (k == lead || counts[k] == 0) continue;
      SelectionTrajectories::Along const other = trajectories_.along(k, e);
      all.ledger.merge(other.result.ledger);
      add_ranges(other, report);
      append(leading, other, all);
      own(k, all, owners);
    }
    say_of_models(e, report);
    Experiment const& experiment = leading.data->experiment;
    report.predictions.push_back(bands_along(leading.trajectory->quantities(), all, experiment, leading.model()));
    add_variances(leading, all, owners, report.predictions.back());
    Findings const noise_findings = leave_out_noise(leading.model(), report.predictions.back());
    if (e == 0) report.findings.insert(report.findings.end(), noise_findings.begin(), noise_findings.end());
    report.ledger.merge(all.ledger);
    bool const several = what_.candidate_experiments[lead].size() > 1;
    Severity const severity = failure_severity(all.ledger.failed(), all.ledger.solves());
    if (all.failed() > 0)
      report.findings.push_back({FindingCode::failed_predictions,
                                 severity,
                                 {experiment.name},
                                 fmt::format("{} of {} trajectories{} do not stay finite and are left out of the bands",
                                             all.failed(), what_.draws, several ? " on " + experiment.name : ""),
                                 "a model diverges on this input at some draws: narrow the priors, or check the equation"});
    for (Finding& finding : band_findings(report.predictions.back(), all.failed(), leading_failed, several))
      report.findings.push_back(std::move(finding));
  }

  void add_ranges(SelectionTrajectories::Along const& along, Report& report) const {
    for (Finding& finding : check_ranges(along.model(), along.data->experiment, along.solver, along.start_rows, along.parameters,
                                         session_.abandonable()))
      report.findings.push_back(std::move(finding));
  }

  /// Once, with the first experiment.
  void say_of_models(std::size_t e, Report& report) const {
    if (e != 0) return;
    std::vector<std::string> shares, names;
    for (std::size_t k = 0; k < trajectories_.counts().size(); ++k)
      if (int const count = trajectories_.counts()[k]; count > 0) {
        names.push_back(session_.file.candidates[static_cast<std::size_t>(select_.candidates)].models[k].name);
        shares.push_back(fmt::format("{} of `{}`", count, names.back()));
      }
    if (shares.size() > 1)
      report.findings.push_back({FindingCode::averaged_over_models, Severity::note, std::move(names),
                                 fmt::format("trajectories: {}", fmt::join(shares, ", ")), ""});
    report.findings.push_back({FindingCode::without_noise,
                               Severity::note,
                               {},
                               find_selector(select_.backend)->run == nullptr
                                   ? "the bands are of the response alone: predictions of a selection leave out the noise"
                                   : "the bands are of the response alone: a selection by distance does not estimate the noise",
                               ""});
  }

  /// Channels of another model join by name, in the leading model's unit; what it does not have stays as it is.
  static void append(SelectionTrajectories::Along const& leading, SelectionTrajectories::Along const& other,
                     Trajectory::Result& all) {
    auto const& quantities = leading.trajectory->quantities();
    for (std::size_t q = 0; q < quantities.size(); ++q) {
      if (quantities[q].channel < 0) continue;
      Channel const& to = leading.model().channels[static_cast<std::size_t>(quantities[q].channel)];
      for (std::size_t o = 0; o < other.trajectory->quantities().size(); ++o) {
        TrajectoryQuantity const& joining = other.trajectory->quantities()[o];
        if (joining.channel < 0 || joining.name != quantities[q].name) continue;
        Channel const& from = other.model().channels[static_cast<std::size_t>(joining.channel)];
        std::vector<std::vector<double>> values = other.result.drawn(o);
        BetweenQuantities(from, to).apply(values);
        std::move(values.begin(), values.end(), std::back_inserter(all.drawn(q)));
      }
    }
  }

  /// Of each quantity the candidate that each of its trajectories is of.
  using Owners = std::vector<std::vector<std::size_t>>;
  static void own(std::size_t candidate, Trajectory::Result const& all, Owners& owners) {
    for (std::size_t q = 0; q < owners.size(); ++q) owners[q].resize(all.drawn(q).size(), candidate);
  }

  /// Of channels, which several models may have: what parameters and models add to the variance of the band. The noise is unknown.
  static void add_variances(SelectionTrajectories::Along const& leading, Trajectory::Result const& all, Owners const& owners,
                            Prediction& prediction) {
    auto const& quantities = leading.trajectory->quantities();
    for (std::size_t q = 0; q < quantities.size(); ++q) {
      if (quantities[q].channel < 0) continue;
      auto const band = std::ranges::find_if(prediction.quantities,
                                             [&](PredictedQuantity const& each) { return each.name == quantities[q].name; });
      auto const draws = usable_trajectories(all.drawn(q));
      if (band == prediction.quantities.end() || draws.usable.size() < 2) continue;
      std::vector<std::vector<double>> groups(1 + *std::ranges::max_element(owners[q]));
      for (std::size_t i = 0; i < draws.predictable.size(); ++i) {
        for (auto& group : groups) group.clear();
        for (std::vector<double> const* each : draws.usable)
          groups[owners[q][static_cast<std::size_t>(each - all.drawn(q).data())]].push_back((*each)[i]);
        bool const known = draws.predictable[i] != 0;
        VarianceSplit const split = known ? split_pooled(groups) : VarianceSplit();
        band->variance.parameter.push_back(known ? split.parameter : std::nan(""));
        band->variance.model.push_back(known ? split.model : std::nan(""));
      }
    }
  }

  Session& session_;
  Task const& task_;
  PredictTask const& what_;
  Task const& select_task_;
  SelectTask const& select_;
  std::uint64_t seed_;
  SelectionTrajectories trajectories_;
};

}  // namespace

ExitCode run_predict_selection(Session& session, Task const& task, PredictTask const& what) {
  return PredictSelection(session, task, what).run();
}

}  // namespace sysid
