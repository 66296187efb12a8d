// The comparison with the modes, and the search that follows it.
#include "app/search/higher_place.hpp"

#include <algorithm>
#include <utility>

#include "app/search/solver_refinement.hpp"
#include "search/global/search.hpp"
#include "search/laplace.hpp"
#include "search/mode_findings.hpp"
#include "search/objective.hpp"

namespace sysid {
namespace {

constexpr double rise = 0.5;  // nats: less is what two searches to one mode may differ by on a rough density

}  // namespace

std::vector<double> place_above_modes(FitResult const& result, Target const& target, ObjectiveKind objective_kind,
                                      std::vector<Mode> const& modes, bool hierarchical) {
  constexpr double higher = 3;  // nats
  if (modes.empty() || hierarchical) return {};
  if (!result.higher_place.empty()) return result.higher_place;
  if (objective_kind != ObjectiveKind::posterior || target.is_estimated()) return {};
  Draws::Best const best = result.draws.best();
  if (best.values == nullptr || !(best.log_density > highest(modes) + higher)) return {};
  LaneArray const theta = coordinates_of(target, *best.values);
  std::vector<double> place;
  for (int p = 0; p < theta.rows(); ++p) place.push_back(theta(p, 0));
  return place;
}

HigherSearch search_from_place(std::vector<double> const& place, Target const& target, ObjectiveKind objective_kind,
                               Preparation& preparation, RunContext& context) {
  std::vector<Eigen::VectorXd> starts{Eigen::Map<Eigen::VectorXd const>(place.data(), std::ssize(place))};
  for (Mode const& mode : preparation.modes) starts.push_back(theta_of(mode));
  double const before = highest(preparation.modes);
  SearchResult found = search_from(target, objective_kind, to_lanes(starts), context, "searching from a point of higher density");
  if (found.interrupted) return HigherSearch::interrupted;
  ++preparation.searched_again;
  if (found.failure || !(highest(found.modes) > before + rise)) return HigherSearch::nothing;
  preparation.modes = std::move(found.modes);
  replace_mode_findings(preparation.findings, found.findings);
  return HigherSearch::found;
}

}  // namespace sysid
