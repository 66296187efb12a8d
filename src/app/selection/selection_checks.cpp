// Compares the particles with evidences, noise, residuals and integration errors.
#include "app/selection/selection_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "app/selection/likelihood_check.hpp"
#include "app/session/fit_target.hpp"
#include "core/numeric/statistics.hpp"
#include "core/text/number.hpp"
#include "diagnostics/tolerance/tolerance_check.hpp"
#include "experiment/noise_statement.hpp"
#include "likelihood/trajectory.hpp"

namespace sysid {
namespace {

/// A finer solver may move the median distance by this part of the threshold.
constexpr double tolerable_shift = 0.05;

/// By so many sds a solver may put parameters of a candidate off.
constexpr double tolerable_move_of_candidate = 0.5;

void name_candidate(Candidate const& candidate, Findings& findings) {
  for (Finding& finding : findings) {
    finding.names.insert(finding.names.begin(), candidate.what->name);
    finding.message = fmt::format("`{}`: {}", candidate.what->name, finding.message);
  }
}

/// What noise leaves of a candidate's distance at one of its parameter vectors (declared); nothing but for normal noise.
struct Floor {
  double distance;
  std::string noise;  // "sd 1.2e-6 [m] in displacement"
};

std::optional<Floor> floor_at(Session const& session, Candidate const& candidate, Distance const& distance, ConstLanes declared) {
  Model const& model = candidate.compiled->model;
  Floor floor;
  std::vector<double> sd(model.channels.size());
  for (std::size_t c = 0; c < model.channels.size(); ++c) {
    Channel const& channel = model.channels[c];
    if (candidate.measure.weights[c] == 0) continue;
    if (!channel.noise.row->gaussian) return std::nullopt;
    double sum = 0, count = 0;
    for (std::size_t e = 0; e < candidate.data.size(); ++e) {
      Experiment const& experiment = candidate.data[e].experiment;
      LaneArray parameters(static_cast<int>(model.parameters.size()), 1);
      candidate.space->select(candidate.space->values_of_declared(declared), static_cast<int>(e), parameters);
      Trajectory const trajectory(candidate.compiled, experiment, candidate.fit.solver, start_rows(candidate.fit.start),
                                  session.abandonable());
      auto const arguments = trajectory.noise_arguments(parameters, static_cast<int>(c));
      for (std::size_t i = 0; i < arguments.size(); ++i)
        if (experiment.scored[i] != 0 && !experiment.measured[c].empty() && std::isfinite(experiment.measured[c][i]))
          sum += arguments[i][1] * arguments[i][1], count += 1;
    }
    sd[c] = count > 0 ? std::sqrt(sum / count) : 0;
    floor.noise += fmt::format("{}sd {}{} in {}", floor.noise.empty() ? "" : ", ", significant(channel.from_si(sd[c]), 3),
                               channel.unit ? " [" + channel.unit_text() + "]" : "", channel.name);
  }
  floor.distance = distance.floor(sd);
  return std::isfinite(floor.distance) ? std::optional(floor) : std::nullopt;
}

/// A death that the likelihood confirms was none of chance.
void confirm_deaths(SelectionReport& selection, Findings& findings) {
  for (std::size_t m = 0; m < selection.result.models.size(); ++m) {
    SelectedModel& model = selection.result.models[m];
    auto const& by_likelihood = selection.likelihoods[m];
    if (!model.by_chance || !by_likelihood || by_likelihood->probability > tolerable_loss) continue;
    model.by_chance = false;
    std::erase_if(findings, [&](Finding const& each) {
      return each.code == FindingCode::model_lost_by_chance && each.names == std::vector{model.name};
    });
  }
}

}  // namespace

void add_likelihoods(std::vector<Candidate> const& candidates, std::vector<CandidatePosterior> const& posteriors,
                     SelectionReport& selection, Findings& findings) {
  selection.likelihoods = evidences(candidates, posteriors, selection.result);
  confirm_deaths(selection, findings);
  std::vector<std::optional<double>> probabilities;
  for (auto const& check : selection.likelihoods) probabilities.push_back(check ? std::optional(check->probability) : std::nullopt);
  for (Finding& finding : compare_probabilities(selection.result, probabilities, selection.floor))
    findings.push_back(std::move(finding));
}

void add_noise_floor(Session const& session, std::vector<Candidate> const& candidates, ModelSelectionTarget const& target,
                     std::vector<CandidatePosterior> const& posteriors, SelectionReport& selection) {
  // A disturbance takes simulations away from the record as noise does: noise alone is no floor.
  if (std::any_of(candidates.begin(), candidates.end(), [](Candidate const& each) { return each.compiled->model.filtered(); }))
    return;
  auto const lead = static_cast<std::size_t>(selection.leader());
  bool const stated = candidates[lead].space->dimension() == candidates[lead].simulated->dimension();
  std::optional<Floor> lowest;
  if (stated) {
    SelectedModel const& best = selection.result.models[lead];
    LaneArray declared(candidates[lead].space->dimension(), 1);
    for (int d = 0; d < declared.rows(); ++d) declared(d, 0) = best.summaries[static_cast<std::size_t>(d)].mean;
    lowest = floor_at(session, candidates[lead], target.distance(static_cast<int>(lead)), declared);
  }
  // A model that cannot follow the data takes its misfit for noise: the one that needs the least is nearest to the truth.
  for (std::size_t k = 0; !stated && k < posteriors.size(); ++k) {
    if (posteriors[k].modes.empty() || posteriors[k].given_up) continue;
    LaneArray declared(candidates[k].space->dimension(), 1);
    for (int d = 0; d < declared.rows(); ++d) declared(d, 0) = posteriors[k].modes.front().declared[static_cast<std::size_t>(d)];
    auto const floor = floor_at(session, candidates[k], target.distance(static_cast<int>(k)), declared);
    if (floor && (!lowest || floor->distance < lowest->distance)) lowest = floor;
  }
  if (!lowest) return;
  selection.floor = lowest->distance;
  selection.floor_words = fmt::format("{} noise, {}", stated ? "the stated" : "the fitted", lowest->noise);
}

Findings check_threshold(SelectionReport const& selection) {
  if (!selection.floor) return {};
  double const floor = *selection.floor;
  double const threshold = selection.result.threshold;
  if (!std::isfinite(threshold) || threshold <= far_from_floor * floor) return {};
  return {
      {FindingCode::threshold_above_noise,
       Severity::warning,
       {},
       fmt::format("the final threshold {} is {} times the noise floor {}, the distance due to {}", significant(threshold, 4),
                   significant(threshold / floor, 2), significant(floor, 4), selection.floor_words),
       "models that differ by less cannot be distinguished: let the run stop later (a smaller "
       "`relative_change`, or a longer `schedule`); if the threshold stays above the noise floor, none of the models is right"}};
}

FitCheck check_candidate(Session& session, Candidate const& candidate, CandidatePosterior const& posterior) {
  if (posterior.modes.empty() || posterior.given_up) return {};
  FitCheck check = check_residuals(
      *likelihood_target(session, candidate, posterior.solver, session.abandonable()), posterior.modes.front().declared,
      UserText{.mentions = [&](std::string const& name) { return mentions(session.source, name); },
               .noise_statement_with = [&](Channel const& channel,
                                           std::string const& sum) { return noise_statement_with(session.source, channel, sum); },
               .time_name = [&](Channel const& channel) { return time_name(session.source, channel); }});
  name_candidate(candidate, check.findings);
  return check;
}

Findings check_solver(Session& session, Candidate const& candidate, Draws const& draws, std::vector<Mode> const& modes,
                      SolverSettings const& solver, std::uint64_t seed, bool leads) {
  if (!candidate.compiled->model.integrated() || solver.row().exact || draws.total() < 2) return {};
  Ledger untold;
  auto const target = [&](SolverSettings const& by) { return likelihood_target(session, candidate, by, session.abandonable()); };
  SolverCheck const check = check_draws(*target(solver), *target(solver.finer()), draws, modes, seed, untold);
  bool const fails = check.outcome == SolverCheck::Outcome::fails;
  double const move = fails ? std::numeric_limits<double>::infinity() : check.largest();
  if (check.holds() || !(move > tolerable_move_of_candidate)) return {};
  return {{FindingCode::integration_step,
           solver.as_model ? Severity::note
           : leads         ? Severity::error
                           : Severity::warning,
           {candidate.what->name},
           fails ? fmt::format("with {}, draws of `{}` cannot be simulated", solver.finer_words(), candidate.what->name)
                 : fmt::format("the error of {} moves parameters of `{}` by {}", solver.text(), candidate.what->name,
                               move > 5 ? "more than 5 sds" : fmt::format("{:.2g} sd", move)),
           solver.as_model ? "nothing, if the solver is meant to be part of the model"
                           : fmt::format("select again with `{}`", solver.finer().option())}};
}

Findings check_distances(SelectionTarget const& finer, int model, SelectionResult const& result, SolverSettings const& solver) {
  SelectedModel const& selected = result.models[static_cast<std::size_t>(model)];
  int const count = std::min<int>(100, static_cast<int>(selected.distance.size()));
  std::vector<double> distance(static_cast<std::size_t>(count)), shift;
  std::vector<Simulated> ending(static_cast<std::size_t>(count));
  SelectionTarget::Batch const batch{model, selected.theta.view().columns(0, count), distance, ending};
  finer.distances({&batch, 1}, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < distance.size(); ++i) shift.push_back(std::abs(distance[i] - selected.distance[i]));
  double const median = upper_median(std::move(shift));
  if (solver.as_model || median <= tolerable_shift * result.threshold) return {};
  std::string const other = solver.other_methods();
  std::string const what =
      !std::isfinite(median) ? std::string("half of the particles or more overflow: their distances depend on the integrator")
      : result.threshold == 0
          ? fmt::format("distances change by {:.2g} at a threshold of 0: they depend on the integrator", median)
          : fmt::format("distances change by {:.2g} times the threshold: they depend on the integrator", median / result.threshold);
  return {{FindingCode::step_not_settled,
           median < result.threshold ? Severity::warning : Severity::error,
           {selected.name},
           fmt::format("with {}, {}", solver.finer_words(), what),
           fmt::format("use a finer solver: `{}`{}", solver.finer().option(), other.empty() ? "" : ", or " + other)}};
}

}  // namespace sysid
