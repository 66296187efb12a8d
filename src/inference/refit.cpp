// A few Levenberg-Marquardt rounds and a Laplace approximation per mode.
#include "inference/refit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "inference/descent.hpp"
#include "inference/laplace.hpp"

namespace sysid {
namespace {

constexpr int rounds = 60;
constexpr int scale_draws = 512;  // enough to know the prior's widths, which is all that is asked of them
constexpr std::uint64_t refit_step = 2;

}  // namespace

std::vector<Mode> refit(Target const& target, std::vector<Mode> const& modes, std::uint64_t seed, Ledger& ledger) {
  LaneArray draws(target.dimension(), scale_draws);
  target.sample_prior({seed, Purpose::start, 0, refit_step}, draws);
  Objective const objective = make_objective(target, Aim::posterior, draws);
  std::vector<Climber> climbers;
  std::vector<Eigen::VectorXd> points;
  for (Mode const& mode : modes) points.push_back(theta_of(mode));
  if (points.empty()) return {};
  std::vector<double> const density = objective.log_density(to_lanes(points), ledger);
  for (std::size_t m = 0; m < modes.size(); ++m) climbers.push_back(climber_at(points[m], density[m]));
  climb(objective, climbers, rounds, ledger, {});
  std::vector<Mode> result;
  for (std::size_t m = 0; m < modes.size(); ++m) {
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
  }
  return result;
}

double largest_move(Mode const& before, Mode const& after) {
  if (!std::isfinite(after.log_density)) return std::numeric_limits<double>::infinity();
  double most = 0;
  for (std::size_t p = 0; p < before.declared.size(); ++p)
    if (before.sd[p] > 0) most = std::max(most, std::abs(after.declared[p] - before.declared[p]) / before.sd[p]);
  return most;
}

}  // namespace sysid
