// `predict` of a selection: trajectories of all living candidates' particles, as many of each as it is probable.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/bands.hpp"
#include "app/experiments.hpp"
#include "app/fit_target.hpp"
#include "app/function_ranges.hpp"
#include "app/reporting.hpp"
#include "app/resolved.hpp"
#include "app/restoring_force.hpp"
#include "app/session.hpp"
#include "app/solver_record.hpp"
#include "app/stored_draws.hpp"
#include "core/diagnostic.hpp"
#include "likelihood/simulated_parameters.hpp"
#include "likelihood/trajectory.hpp"
#include "report/result.hpp"
#include "report/terminal.hpp"

namespace sysid {
namespace {

/// How many of `wanted` trajectories each candidate has: its share, the rest to the largest remainders.
std::vector<int> shares(std::vector<SelectedCandidate> const& candidates, int wanted) {
  std::vector<int> counts;
  std::vector<std::pair<double, std::size_t>> remainders;
  int given = 0;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    double const exact = candidates[k].draws.total() == 0 ? 0 : candidates[k].probability * wanted;
    counts.push_back(static_cast<int>(std::floor(exact)));
    given += counts.back();
    remainders.emplace_back(exact - std::floor(exact), k);
  }
  std::stable_sort(remainders.begin(), remainders.end(), [](auto const& a, auto const& b) { return a.first > b.first; });
  for (std::size_t r = 0; given < wanted && r < remainders.size(); ++r, ++given) ++counts[remainders[r].second];
  return counts;
}

class PredictSelection {
 public:
  PredictSelection(Session& session, Task const& task, PredictTask const& what)
      : session_(session),
        task_(task),
        what_(what),
        select_task_(session.file.tasks[static_cast<std::size_t>(what.fit)]),
        select_(std::get<SelectTask>(select_task_.what)),
        candidates_(selected_candidates(session, what.fit)),
        seed_(session.seed(task, what.seed)) {}

  ExitCode run() {
    if (what_.redraw_each_step)
      throw UserError({Severity::error,
                       "E6519",
                       "parameters cannot be redrawn at each step where models differ",
                       Label{task_.span, {}},
                       {},
                       "leave `redraw = step` out"});
    std::size_t const lead =
        static_cast<std::size_t>(std::max_element(candidates_.begin(), candidates_.end(),
                                                  [](auto const& a, auto const& b) { return a.probability < b.probability; }) -
                                 candidates_.begin());
    std::vector<int> const counts = shares(candidates_, what_.draws);
    Report report = begin_report(session_, task_, select_.fits[lead].model,
                                 fmt::format("predict {} on {} with draws({})", select_task_.name,
                                             data_names(session_.file, what_.candidate_experiments[lead]), what_.draws),
                                 seed_);
    for (std::size_t e = 0; e < what_.candidate_experiments[lead].size(); ++e) predict(e, lead, counts, report);
    report.settings = {{"draws", static_cast<std::int64_t>(what_.draws)}, {"start", start_text(what_.start)}};
    if (session_.file.models[static_cast<std::size_t>(select_.fits[lead].model)].integrated())
      add_solver(select_.fits[lead].solver, report.settings);
    report.verdict = grade(report) == Severity::error ? "do not use these bands: too many trajectories are left out"
                     : report.ledger.failed() > 0     ? "some trajectories do not stay finite"
                                                      : "all trajectories stay finite";
    write_result(report, session_.result_folder(task_), session_.options.pictures());
    session_.out << terminal_summary(report);
    return grade(report) == Severity::error ? ExitCode::doubtful : ExitCode::success;
  }

 private:
  /// Adds bands of experiment e over all candidates' trajectories, findings and failures.
  void predict(std::size_t e, std::size_t lead, std::vector<int> const& counts, Report& report) const {
    std::vector<TrajectoryQuantity> quantities;
    Trajectory::Result all;
    std::unique_ptr<Trajectory> leading;
    Experiment experiment;
    Model const* leading_model = nullptr;
    std::string of_models;
    int leading_failed = 0;
    // The leading one first: its quantities are those of the bands, channels of the others are found by name.
    std::vector<std::size_t> order = {lead};
    for (std::size_t k = 0; k < counts.size(); ++k)
      if (k != lead && counts[k] > 0) order.push_back(k);
    for (std::size_t const k : order) {
      FitTask const& fit = select_.fits[k];
      bool const free_start = what_.start.kind == StartRule::Kind::estimated;
      auto const compiled = session_.compiled(fit.model, free_start, fit.solver.method, what_.prediction);
      std::vector<ExperimentData> const data =
          load_experiments(session_, what_.candidate_experiments[k], session_.file.models[static_cast<std::size_t>(fit.model)],
                           what_.start, what_.prediction);
      auto const space = parameter_space(without_noise_parameters(compiled->model), fit.experiments);
      LaneArray const declared = spread(candidates_[k].draws, counts[k]);
      LaneArray parameters(static_cast<int>(compiled->model.parameters.size()), declared.width());
      int const fitted = what_.fitted[e];
      if (fitted >= 0)
        space->select(space->values_of_declared(declared), fitted, parameters);
      else
        parameters = space->of_new_experiment(declared, data[e].use.constants,
                                              {seed_, Purpose::population, static_cast<std::uint64_t>(e) << 32, k});
      auto trajectory = std::make_unique<Trajectory>(
          compiled, data[e].experiment, fit.solver, free_start ? what_.start.rows : 0, session_.options.execution,
          [this, model = fit.model](NodeId node, Graph const& graph) { return session_.describe(model, graph, node); });
      Trajectory::Result result = trajectory->run(parameters, prediction_noise(seed_, static_cast<int>(e)));
      all.ledger.merge(result.ledger);
      for (Finding& finding : check_ranges(compiled->model, data[e].experiment, fit.solver, free_start ? what_.start.rows : 0,
                                           parameters, session_.options.execution))
        report.findings.push_back(std::move(finding));
      if (k == lead) {
        for (RestoringForce& force :
             restoring_forces(compiled->model, trajectory->quantities(), result, parameters, data[e].experiment))
          report.forces.push_back(std::move(force));
        leading_failed = result.failed();
        quantities = trajectory->quantities();
        all.values = std::move(result.values);
        experiment = data[e].experiment;
        leading_model = &compiled->model;
        leading = std::move(trajectory);
        report.data.push_back(describe_data(session_.file, data[e], compiled->model));
      } else {
        append(quantities, *leading_model, *trajectory, compiled->model, result, all);
      }
    }
    for (std::size_t k = 0; k < counts.size(); ++k)
      if (counts[k] > 0)
        of_models += fmt::format("{}{} of `{}`", of_models.empty() ? "" : ", ", counts[k],
                                 session_.file.candidates[static_cast<std::size_t>(select_.candidates)].models[k].name);
    if (e == 0 && order.size() > 1)
      report.findings.push_back({Severity::note, "averaged_over_models", fmt::format("trajectories: {}", of_models), ""});
    if (e == 0)
      report.findings.push_back({Severity::note, "without_noise",
                                 "the bands are of the response alone: a selection by distance says nothing about the noise", ""});
    all.noisy.resize(leading_model->channels.size());  // none
    report.predictions.push_back(bands_along(leading->quantities(), all, experiment, *leading_model));
    Findings const left_out = leave_out_noise(*leading_model, report.predictions.back());
    if (e == 0) report.findings.insert(report.findings.end(), left_out.begin(), left_out.end());
    report.ledger.merge(all.ledger);
    bool const several = what_.candidate_experiments[lead].size() > 1;
    Severity const severity = failure_severity(all.ledger.failed(), all.ledger.solves());
    if (all.failed() > 0)
      report.findings.push_back({severity, "failed_predictions",
                                 fmt::format("{} of {} trajectories{} do not stay finite and are left out of the bands",
                                             all.failed(), what_.draws, several ? " on " + experiment.name : ""),
                                 "the posterior reaches where a model diverges on this input"});
    for (Finding& finding : band_findings(report.predictions.back(), all.failed(), leading_failed, several))
      report.findings.push_back(std::move(finding));
  }

  /// Channels of another model join by name, in the leading model's unit; what it does not have stays as it is.
  static void append(std::vector<TrajectoryQuantity> const& quantities, Model const& leading, Trajectory const& other,
                     Model const& other_model, Trajectory::Result const& result, Trajectory::Result& all) {
    for (std::size_t q = 0; q < quantities.size(); ++q) {
      if (quantities[q].channel < 0) continue;
      Channel const& to = leading.channels[static_cast<std::size_t>(quantities[q].channel)];
      for (std::size_t o = 0; o < other.quantities().size(); ++o) {
        if (other.quantities()[o].channel < 0 || other.quantities()[o].name != quantities[q].name) continue;
        Channel const& from = other_model.channels[static_cast<std::size_t>(other.quantities()[o].channel)];
        bool const same = from.from_si(1) == to.from_si(1) && from.from_si(0) == to.from_si(0);
        for (std::vector<double> values : result.values[o]) {
          if (!same)
            for (double& value : values) value = to.from_si(from.to_si(value));
          all.values[q].push_back(std::move(values));
        }
      }
    }
  }

  Session& session_;
  Task const& task_;
  PredictTask const& what_;
  Task const& select_task_;
  SelectTask const& select_;
  std::vector<SelectedCandidate> const& candidates_;
  std::uint64_t seed_;
};

}  // namespace

ExitCode run_predict_selection(Session& session, Task const& task, PredictTask const& what) {
  return PredictSelection(session, task, what).run();
}

}  // namespace sysid
