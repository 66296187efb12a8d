// Averages over models, and the parameters for which there is no average.
#include "app/selection/shared_parameters.hpp"

#include <algorithm>
#include <optional>

#include "app/session/reporting.hpp"

namespace sysid {
namespace {

/// Rows that a name stands for in a model's parameters: itself, or one for each experiment. by_distance: parameters of the noise
/// have no particles.
std::vector<std::string> rows_of(std::string const& name, std::vector<Candidate> const& candidates, bool by_distance) {
  std::vector<std::string> rows;
  for (Candidate const& each : candidates) {
    ParameterSpace const& space = by_distance ? *each.simulated : *each.space;
    for (int k = 0; k < space.dimension(); ++k) {
      std::string const& row = space.infos()[static_cast<std::size_t>(k)].name;
      bool const stands_for = space.model().parameters[static_cast<std::size_t>(parameter_of(space, k))].name == name;
      if (stands_for && std::find(rows.begin(), rows.end(), row) == rows.end()) rows.push_back(row);
    }
  }
  return rows;
}

std::optional<WeightedSummary> averaged(std::string const& row, SelectionResult const& result) {
  std::vector<double> values, weights;
  std::string unit;
  double total = 0;
  for (SelectedModel const& model : result.models) {
    if (model.died_in > 0) continue;
    for (std::size_t d = 0; d < model.parameters.size(); ++d) {
      if (model.parameters[d].name != row) continue;
      unit = model.parameters[d].unit;
      for (std::size_t j = 0; j < model.weight.size(); ++j) {
        values.push_back(model.declared(static_cast<int>(d), static_cast<int>(j)));
        weights.push_back(model.weight[j] * model.probability);
        total += weights.back();
      }
    }
  }
  if (!(total > 0)) return std::nullopt;
  for (double& w : weights) w /= total;
  return summarise_weighted(row, unit, values, weights);
}

/// The declared prior of the first candidate that has the parameter: the checker has seen to it that the others have the same.
/// Nothing for what is fixed in all of them: it has no prior to stay at.
std::optional<SelectionReport::Unmoved> unmoved(Session const& session, std::string const& name,
                                                std::vector<Candidate> const& candidates, std::string why) {
  for (Candidate const& each : candidates)
    for (PriorInfo const& prior : declared_priors(session, each.fit.model))
      if (prior.name == name) return SelectionReport::Unmoved{name, prior.unit, prior.text, std::move(why)};
  return std::nullopt;
}

}  // namespace

void summarise_shared(Session const& session, CandidateSet const& set, std::vector<Candidate> const& candidates,
                      SelectionReport& selection) {
  for (std::string const& name : set.shared) {
    std::vector<std::string> const rows = rows_of(name, candidates, !selection.result.jumps);
    std::size_t const before = selection.shared.size();
    for (std::string const& row : rows)
      if (auto summary = averaged(row, selection.result)) selection.shared.push_back(std::move(*summary));
    if (selection.shared.size() > before) continue;
    auto kept = unmoved(session, name, candidates,
                        rows.empty() ? "only the noise uses it, and a simulation without noise gives no information about it"
                                     : "no remaining model has it");
    if (kept) selection.shared_unmoved.push_back(std::move(*kept));
  }
}

}  // namespace sysid
