// A few Levenberg-Marquardt rounds and a Laplace approximation per mode.
#include "search/refit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numeric/not_finite.hpp"
#include "search/descent.hpp"
#include "search/laplace.hpp"
#include "search/settle.hpp"

namespace sysid {
namespace {

constexpr int rounds = 20, evaluations = 60;  // rounds of a density that vanishes at bounds, too
constexpr std::uint64_t refit_step = 2;

}  // namespace

std::vector<Mode> refit(Target const& target, ObjectiveKind objective_kind, std::vector<Mode> const& modes, std::uint64_t seed,
                        Ledger& ledger, std::function<bool()> const& stop) {
  Objective const objective = make_objective(target, objective_kind, seed, refit_step);
  std::vector<Climber> climbers;
  std::vector<Eigen::VectorXd> points;
  for (Mode const& mode : modes) points.push_back(theta_of(mode));
  if (points.empty()) return {};
  std::vector<double> const density = objective.log_density(to_lanes(points), ledger);
  for (std::size_t m = 0; m < modes.size(); ++m) climbers.push_back(climber_at(points[m], density[m]));
  climb(objective, climbers, target.has_gradient() || objective_kind == ObjectiveKind::posterior ? evaluations : rounds, ledger,
        stop);
  settle(objective, climbers, settling_rounds, ledger, stop);
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
    result.push_back(laplace_mode(objective, climbers[m].theta, guess, ledger));
    result.back().share = modes[m].share;
    result.back().hits = modes[m].hits;
    result.back().stalled = climbers[m].stalled;
  }
  return result;
}

Move largest_move(Mode const& before, Mode const& after) {
  if (!std::isfinite(before.log_density) || !std::isfinite(after.log_density)) return {0, infinity, infinity};
  Move most;
  for (std::size_t p = 0; p < before.declared.size(); ++p) {
    if (!(before.sd[p] > 0)) continue;
    double const value = std::abs(after.declared[p] - before.declared[p]) / before.sd[p];
    double const size = value + std::abs(after.sd[p] - before.sd[p]) / before.sd[p];
    if (size > most.size) most = {static_cast<int>(p), size, value};
  }
  return most;
}

}  // namespace sysid
