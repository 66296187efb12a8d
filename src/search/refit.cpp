// A few Levenberg-Marquardt rounds and a Laplace approximation per mode.
#include "search/refit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "search/descent.hpp"
#include "search/laplace.hpp"
#include "search/search_step.hpp"
#include "search/settle.hpp"

namespace sysid {
namespace {

constexpr int rounds = 20, evaluations = 60;  // rounds of a density that vanishes at bounds, too
constexpr std::uint64_t refit_step = 2;

}  // namespace

std::vector<Mode> refit(Target const& target, ObjectiveKind objective_kind, std::vector<Mode> const& modes, std::uint64_t seed,
                        Ledger& ledger, std::function<bool()> const& stop, std::vector<double>* gains, Journal* journal) {
  Objective const objective = make_objective(target, objective_kind, seed, refit_step);
  std::vector<Climber> climbers;
  std::vector<Eigen::VectorXd> points;
  for (Mode const& mode : modes) points.push_back(theta_of(mode));
  if (points.empty()) return {};
  std::vector<double> const density = log_density_in_blocks(objective, to_lanes(points), ledger, stop, journal);
  for (std::size_t m = 0; m < modes.size(); ++m) climbers.push_back(climber_at(points[m], density[m]));
  climb(objective, climbers, target.climbs_by_gradient() || objective_kind == ObjectiveKind::posterior ? evaluations : rounds,
        ledger, stop, journal);
  settle(objective, climbers, settling_rounds, ledger, stop, journal);
  std::vector<Mode> result;
  for (std::size_t m = 0; m < modes.size(); ++m) {
    if (stop && stop()) {
      result.push_back(modes[m]);
      continue;
    }
    if (!std::isfinite(climbers[m].log_density)) {
      result.push_back(modes[m]);
      result.back().log_density = -std::numeric_limits<double>::infinity();
      continue;
    }
    Eigen::MatrixXd const guess = climbers[m].curvature.size() > 0
                                      ? climbers[m].curvature
                                      : Eigen::MatrixXd(objective.scale.cwiseAbs2().cwiseInverse().asDiagonal());
    result.push_back(kept_mode(journal, ledger, stop, [&] { return laplace_mode(objective, climbers[m].theta, guess, ledger); }));
    result.back().share = modes[m].share;
    result.back().hits = modes[m].hits;
    result.back().stalled = climbers[m].stalled;
  }
  for (std::size_t m = 0; gains != nullptr && m < modes.size(); ++m) gains->push_back(result[m].log_density - density[m]);
  return result;
}

}  // namespace sysid
