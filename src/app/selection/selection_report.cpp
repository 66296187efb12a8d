// Parts of reports that selections by distances and by likelihoods share.
#include "app/selection/selection_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/process/unknown_functions.hpp"
#include "app/session/fit_end.hpp"
#include "app/session/fit_target.hpp"
#include "app/session/provenance.hpp"
#include "app/session/reporting.hpp"
#include "app/session/resolved.hpp"
#include "diagnostics/bands.hpp"
#include "diagnostics/function_ranges.hpp"
#include "experiment/true_parameters.hpp"
#include "likelihood/trajectory.hpp"
#include "mechanics/restoring_force.hpp"
#include "model/simulated_parameters.hpp"

namespace sysid {
namespace {

void add(Findings const& more, Report& report) { report.findings.insert(report.findings.end(), more.begin(), more.end()); }

/// What the head of the record says of the parameters of the leading model, which others need not have.
void add_true_values(Candidate const& leading, Report& report) {
  for (std::size_t e = 0; e < std::min(report.data.size(), leading.data.size()); ++e)
    report.data[e].true_parameters =
        true_values(leading.data[e].record.comments, leading.compiled->model, leading.data[e].use.name);
}

}  // namespace

void name_absent(std::vector<Candidate> const& candidates, SelectionResult& result) {
  for (std::size_t k = 0; k < std::min(candidates.size(), result.models.size()); ++k) {
    std::vector<bool> const measured = measured_parameters(candidates[k].compiled->model);
    for (int const r : candidates[k].space->sampled()) {
      FittedParameter const& row = candidates[k].space->rows()[static_cast<std::size_t>(r)];
      if (!measured[static_cast<std::size_t>(row.parameter)]) result.models[k].absent.push_back(row.name);
    }
  }
}

Report begin_selection_report(Session& session, Task const& task, SelectTask const& what, std::vector<Candidate> const& candidates,
                              SelectionReport const& selection, std::uint64_t seed) {
  Candidate const& first = candidates.front();
  Candidate const& leading = candidates[static_cast<std::size_t>(selection.leader())];
  CandidateSet const& set = session.file.candidates[static_cast<std::size_t>(what.candidates)];
  Report report = begin_report(
      session, task, leading.fit.model,
      fmt::format("select {} to {} with {}", set.name, data_names(session.file, first.fit.experiments), what.backend), seed);
  add_prediction_rule(leading.compiled->model, leading.fit.prediction, report);
  report.priors = priors_of(*leading.space, report.priors);
  report.findings = selection.result.findings;
  add_fitted_data(session.file, first.data, first.compiled->model, report);
  add_true_values(leading, report);
  for (std::string& name : noise_parameters(*leading.space))
    if (!selection.result.models[static_cast<std::size_t>(selection.leader())].is_absent(name))
      report.noise.push_back(std::move(name));
  for (Candidate const& candidate : candidates)
    look_at_all_data(session.file, candidate.data, candidate.compiled->model, report.findings);
  return report;
}

void add_leading_predictions(Candidate const& leading, LeadingDraws const& draws, std::uint64_t seed,
                             ExecutionOptions const& execution, Report& report) {
  Model const& model = leading.compiled->model;
  int const start = start_rows(leading.fit.start);
  for (std::size_t e = 0; e < leading.data.size(); ++e) {
    Experiment const& experiment = leading.data[e].experiment;
    LaneArray parameters(static_cast<int>(model.parameters.size()), draws.values.width());
    draws.space.select(draws.values, static_cast<int>(e), parameters);
    Trajectory const trajectory(leading.compiled, experiment, draws.solver, start, execution);
    Trajectory::Result result = trajectory.run(parameters, prediction_noise(seed, static_cast<int>(e)));
    if (!draws.with_noise) std::fill(result.noisy.begin(), result.noisy.end(), std::vector<std::vector<double>>());
    report.predictions.push_back(bands_along(trajectory.quantities(), result, experiment, model));
    add_restoring_forces(model, trajectory.quantities(), result, parameters, experiment, report.forces);
    if (!draws.with_noise) {
      Findings const left_out = leave_out_noise(model, report.predictions.back());
      if (e == 0) add(left_out, report);
    }
    add(band_findings(report.predictions.back(), result.failed(), result.failed(), leading.data.size() > 1), report);
    add(check_ranges(model, experiment, draws.solver, start, parameters, execution), report);
    if (e == 0) add(check_expansions(model, parameters), report);
  }
}

}  // namespace sysid
