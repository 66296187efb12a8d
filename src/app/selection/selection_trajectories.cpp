// Particles to parameters of each experiment, and along its record.
#include "app/selection/selection_trajectories.hpp"

#include <algorithm>
#include <cmath>

#include "app/session/exact_steps.hpp"
#include "app/session/fit_target.hpp"
#include "app/session/posterior_trajectories.hpp"
#include "app/session/stored_draws.hpp"
#include "diagnostics/bands.hpp"
#include "model/simulated_parameters.hpp"

namespace sysid {
namespace {

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

}  // namespace

SelectionTrajectories::SelectionTrajectories(Session& session, PredictTask const& what, std::uint64_t seed)
    : session_(session),
      what_(what),
      select_(std::get<SelectTask>(session.file.tasks[static_cast<std::size_t>(what.fit)].what)),
      candidates_(selected_candidates(session, what.fit)),
      seed_(seed),
      counts_(shares(candidates_, what.draws)) {}

std::size_t SelectionTrajectories::lead() const {
  auto const most = std::max_element(candidates_.begin(), candidates_.end(),
                                     [](auto const& a, auto const& b) { return a.probability < b.probability; });
  return static_cast<std::size_t>(most - candidates_.begin());
}

SolverSettings SelectionTrajectories::solver(std::size_t candidate) const {
  FitTask fit = select_.fits[candidate];
  fit.input_errors = what_.candidate_input_errors[candidate];
  return solver_along(session_, fit, candidates_[candidate].solver, what_.candidate_experiments[candidate], what_);
}

SelectionTrajectories::Along SelectionTrajectories::along(std::size_t candidate, std::size_t experiment) const {
  FitTask fit = select_.fits[candidate];
  fit.input_errors = what_.candidate_input_errors[candidate];
  bool const free_start = what_.start.kind == StartRule::Kind::estimated;
  Along out;
  out.solver = solver(candidate);
  out.compiled = session_.compiled(fit, free_start, out.solver.method, what_.prediction);
  out.start_rows = start_rows(what_.start);
  Model const& written = session_.file.models[static_cast<std::size_t>(fit.model)];
  std::vector<ExperimentData> data = load_experiments(session_, what_.candidate_experiments[candidate], written, what_.start,
                                                      rule_of_lags(fit, written, what_.prediction), out.solver);
  if (out.model().filtered()) data[experiment].experiment.corrects = corrected_rows(data[experiment].experiment, what_.prediction);
  out.data = std::make_unique<ExperimentData const>(std::move(data[experiment]));
  auto const space = parameter_space(without_noise_parameters(out.model()), fit.experiments);
  LaneArray const declared = spread_with_repeats(candidates_[candidate].draws, counts_[candidate]);
  out.parameters = LaneArray(static_cast<int>(out.model().parameters.size()), declared.width());
  int const fitted = what_.fitted[experiment];
  if (fitted >= 0)
    space->select(space->values_of_declared(declared), fitted, out.parameters);
  else
    out.parameters = space->of_new_experiment(
        declared, out.data->use.constants, {seed_, Purpose::population, static_cast<std::uint64_t>(experiment) << 32, candidate});
  out.trajectory = std::make_unique<Trajectory const>(
      out.compiled, out.data->experiment, out.solver, out.start_rows, session_.abandonable(),
      [this, model = fit.model](NodeId node, Graph const& graph) { return session_.describe(model, graph, node); });
  out.result = out.trajectory->run(out.parameters, prediction_noise(seed_, static_cast<int>(experiment)));
  out.result.noisy.assign(out.model().channels.size(), {});
  return out;
}

}  // namespace sysid
