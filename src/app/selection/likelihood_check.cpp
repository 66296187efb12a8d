// Local searches that start from particles.
#include "app/selection/likelihood_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/numeric/elementary.hpp"
#include "core/text/number.hpp"

namespace sysid {
namespace {

constexpr int starts = 8;

/// Rows of the target that the particles have, by name; -1: they do not.
std::vector<int> rows_of(ModelTarget const& target, SelectedModel const& model) {
  std::vector<int> rows;
  for (ParameterInfo const& info : target.parameters()) {
    auto const found = std::find_if(model.parameters.begin(), model.parameters.end(),
                                    [&](ParameterInfo const& each) { return each.name == info.name; });
    rows.push_back(found == model.parameters.end() ? -1 : static_cast<int>(found - model.parameters.begin()));
  }
  return rows;
}

/// A model without parameters: its likelihood is its evidence.
std::vector<Mode> only_point(ModelTarget const& target, Ledger& ledger) {
  double value = 0;
  target.log_likelihood(LaneArray(0, 1), {&value, 1}, ledger);
  if (!std::isfinite(value)) return {};
  Mode mode;
  mode.log_density = mode.log_mass = value;
  mode.share = mode.hits = 1;
  return {mode};
}

/// A threshold near the noise floor weighs models by how much of their prior lies within it: no end of the run makes these the
/// probabilities by the likelihood, and below the floor models have died that particles and populations do not bring back.
std::string cure(SelectionResult const& result, std::optional<double> floor) {
  std::string const by_likelihood = "use the probabilities by the likelihood if its noise model is right";
  if (!floor || !std::isfinite(result.threshold) || result.threshold > far_from_floor * *floor)
    return fmt::format("let the run stop later (a smaller `relative_change`, or a longer `schedule`), use more `particles`, or {}",
                       by_likelihood);
  std::string const sampled = fmt::format("{}; `reversible_jump` computes these probabilities by sampling", by_likelihood);
  if (result.threshold * far_from_floor >= *floor)
    return fmt::format(
        "{}: the run has reached the noise floor {}, and neither a later stop nor more `particles` makes the two probabilities "
        "agree",
        sampled, significant(*floor, 4));
  return fmt::format(
      "{}: the threshold {} is below the noise floor {}, so the particles fit the noise of this record, and simpler models that "
      "died do not come back if the run stops later or has more `particles` (`target = {}` ends the run at the floor, where fewer "
      "models have died, but their probabilities still differ from those by the likelihood)",
      sampled, significant(result.threshold, 4), significant(*floor, 4), significant(*floor, 4));
}

}  // namespace

LocalSearches modes_near(ModelTarget const& target, SelectedModel const& model, double least_log_mass, std::uint64_t seed,
                         Ledger& ledger, std::function<bool()> const& stop, Journal* journal) {
  if (target.dimension() == 0) return {only_point(target, ledger), false};
  std::vector<int> order(model.distance.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return model.distance[static_cast<std::size_t>(a)] < model.distance[static_cast<std::size_t>(b)];
  });
  std::vector<int> const rows = rows_of(target, model);
  int const count = order.empty() ? starts : std::min<int>(starts, static_cast<int>(order.size()));
  LaneArray from(target.dimension(), count);
  target.sample_prior({seed, Purpose::start, 0, 3}, from);  // what the particles do not have
  for (int s = 0; s < count && !order.empty(); ++s) {
    // The nearest first, the others evenly over the nearer half.
    int const particle = order[static_cast<std::size_t>(s) * (order.size() / 2) / static_cast<std::size_t>(count)];
    for (std::size_t p = 0; p < rows.size(); ++p)
      if (rows[p] >= 0) from(static_cast<int>(p), s) = model.theta(rows[p], particle);
  }
  return modes_from(target, ObjectiveKind::posterior, from, least_log_mass, seed, ledger, stop, journal);
}

double log_evidence(std::vector<Mode> const& modes) {
  double const none = -std::numeric_limits<double>::infinity();
  double highest = none, sum = 0;
  for (Mode const& mode : modes) highest = std::max(highest, mode.log_mass);
  if (highest == none) return none;
  for (Mode const& mode : modes) sum += elementary::exp(mode.log_mass - highest);
  return highest + elementary::log(sum);
}

Findings compare_probabilities(SelectionResult const& result, std::vector<std::optional<double>> const& by_likelihood,
                               std::optional<double> floor) {
  struct Difference {
    std::size_t model;
    double size;  // of the tolerable one
  };
  std::vector<Difference> differences;
  for (std::size_t m = 0; m < by_likelihood.size(); ++m) {
    if (!by_likelihood[m]) continue;
    double const tolerable = result.models[m].died_in > 0 ? tolerable_loss : tolerable_difference;
    double const size = std::abs(result.models[m].probability - *by_likelihood[m]) / tolerable;
    if (size > 1) differences.push_back({m, size});
  }
  if (differences.empty()) return {};
  std::stable_sort(differences.begin(), differences.end(), [](auto const& a, auto const& b) { return a.size > b.size; });
  std::string each;
  std::vector<std::string> names;
  for (Difference const& difference : differences) {
    SelectedModel const& model = result.models[difference.model];
    names.push_back(model.name);
    each += fmt::format("{}`{}` has probability {:.2f} by the particles and {:.2f} by the likelihood", each.empty() ? "" : "; ",
                        model.name, model.probability, *by_likelihood[difference.model]);
    if (model.died_in > 0) each += fmt::format(" and died in population {}", model.died_in);
  }
  return {{FindingCode::probabilities_disagree, Severity::warning, std::move(names), each, cure(result, floor)}};
}

}  // namespace sysid
