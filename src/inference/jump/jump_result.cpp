// Jumps give probabilities, the weights of their proposals evidences.
#include "inference/jump/jump_result.hpp"

#include <fmt/format.h>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "inference/jump/findings.hpp"

namespace sysid::jump {
namespace {

void fill_draws(Model const& of, KeptDraws const& draws, SelectedModel& model) {
  auto const count = static_cast<int>(draws.log_density.size()), dimension = static_cast<int>(model.parameters.size());
  model.theta = LaneArray(dimension, count);
  model.declared = LaneArray(dimension, count);
  for (int w = 0; w < count; ++w)
    for (int p = 0; p < dimension; ++p)
      model.theta(p, w) =
          draws.theta[static_cast<std::size_t>(w) * static_cast<std::size_t>(dimension) + static_cast<std::size_t>(p)];
  of.candidate->target->constrain(model.theta, model.declared);
  model.log_density = draws.log_density;
  double const constant = elementary::log(model.prior) + of.candidate->log_unit;
  for (double& each : model.log_density) each -= constant;
  model.weight.assign(static_cast<std::size_t>(count), count > 0 ? 1.0 / count : 0);
  if (count == 0) return;
  for (int d = 0; d < dimension; ++d) {
    ParameterInfo const& info = model.parameters[static_cast<std::size_t>(d)];
    model.summaries.push_back(summarise_weighted(info.name, info.unit, model.declared.row(d), model.weight));
  }
}

}  // namespace

void fill_result(std::span<LikelihoodCandidate const> candidates, std::vector<Model> const& models, Plan const& plan,
                 State const& state, SelectionResult& result) {
  std::vector<double> prior;
  for (Model const& model : models) prior.push_back(model.candidate->prior);
  Estimate const found = estimate(state.tally, state.bias, prior);
  JumpRecord record;
  record.chains = plan.chains;
  record.samples = plan.samples;
  record.burn_in = plan.burn_in;
  record.models.resize(candidates.size());
  for (JumpRecord::OfModel& each : record.models) each.log_bayes_factor = each.log_evidence = -infinity;
  double visits = 0;
  for (double const each : state.visits) visits += each;
  for (std::size_t m = 0; m < models.size(); ++m) {
    auto const k = static_cast<std::size_t>(state.live[m]);
    JumpRecord::OfModel& model = record.models[k];
    auto const rate = [m](std::vector<double> const& accepted, std::vector<double> const& all) {
      return all[m] > 0 ? accepted[m] / all[m] : 0;
    };
    model.error = found.error[m];
    model.log_bayes_factor = found.factor[m];
    model.factor_error = found.factor_error[m];
    model.log_evidence = state.weights[m].log_mean() - elementary::log(prior[m]);
    model.evidence_error = state.weights[m].error();
    model.visits = state.visits[m] / visits;
    model.bias = state.bias[m];
    model.accepted_in = rate(state.jumps_in_accepted, state.jumps_in);
    model.accepted_out = rate(state.jumps_out_accepted, state.jumps_out);
    model.accepted_within = rate(state.walks_accepted, state.walks);
    model.spread = found.spread[m];
    model.worth = state.weights[m].worth();
    model.simulations = state.simulations[m];
    result.models[k].probability = found.probability[m];
    result.models[k].share = model.visits;
    fill_draws(models[m], state.draws[m], result.models[k]);
  }
  result.jumps = std::move(record);
  result.stopped_by = fmt::format("`samples = {}` is reached", plan.samples);
  std::vector<std::string> excluded;
  for (auto const& pilot : state.pilots) excluded.push_back(pilot->excluded);
  result.findings = check_jumps(result, excluded);
}

}  // namespace sysid::jump
