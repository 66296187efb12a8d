// Levenberg-Marquardt over lanes.
#include "search/descent.hpp"

#include <algorithm>
#include <cmath>

#include "linear_algebra/decompositions.hpp"
#include "search/ascent.hpp"
#include "search/local_slopes.hpp"
#include "search/search_step.hpp"

namespace sysid {
namespace {

constexpr double prior_difference_width = 1e-3;  // second differences need more
constexpr double most_step = 2;
constexpr double worth_taking = 1e-8;  // predicted gain in log density below which a search is done
constexpr double dampings[] = {0.1, 1, 10, 100};
constexpr int damping_count = 4;

void add_prior(Objective const& objective, std::vector<Climber*> const& block, std::vector<Slope>& slopes) {
  if (objective.objective_kind == ObjectiveKind::likelihood) return;
  int const dimension = objective.dimension();
  int const columns = 2 * dimension + 1;
  LaneArray theta(dimension, columns * static_cast<int>(block.size()));
  for (std::size_t k = 0; k < block.size(); ++k) {
    for (int c = 0; c < columns; ++c) {
      for (int p = 0; p < dimension; ++p) {
        double const shift = c == 2 * p ? 1 : c == 2 * p + 1 ? -1 : 0;
        theta(p, static_cast<int>(k) * columns + c) = block[k]->theta(p) + shift * prior_difference_width * objective.scale(p);
      }
    }
  }
  std::vector<double> const value = objective.log_prior(theta);
  for (std::size_t k = 0; k < block.size(); ++k) {
    double const* const f = value.data() + k * static_cast<std::size_t>(columns);
    for (int p = 0; p < dimension; ++p) {
      double const h = prior_difference_width * objective.scale(p);
      double const slope = (f[2 * p] - f[2 * p + 1]) / (2 * h);
      double const bend = (2 * f[2 * dimension] - f[2 * p] - f[2 * p + 1]) / (h * h);
      if (std::isfinite(slope)) slopes[k].gradient(p) += slope;
      if (std::isfinite(bend) && bend > 0) slopes[k].curvature(p, p) += bend;
    }
  }
}

/// Gradient and Gauss-Newton curvature of every climber of the block.
std::vector<Slope> slopes_of(Objective const& objective, std::vector<Climber*> const& block, Ledger& ledger) {
  int const dimension = objective.dimension(), width = static_cast<int>(block.size());
  LaneArray theta(dimension, width);
  for (int k = 0; k < width; ++k)
    for (int p = 0; p < dimension; ++p) theta(p, k) = block[static_cast<std::size_t>(k)]->theta(p);
  Eigen::VectorXd const steps = difference_width(objective.target) * objective.scale;
  std::vector<Slope> slopes;
  for (LikelihoodSlope& each : local_slopes(objective.target, theta, steps, ledger))
    slopes.push_back({std::move(each.gradient), std::move(each.curvature)});
  add_prior(objective, block, slopes);
  return slopes;
}

Eigen::VectorXd damped_step(Objective const& objective, Slope const& slope, double damping) {
  // In prior widths, so that a weak direction of one unit is not rounded away by a stiff one of another.
  Eigen::VectorXd const& s = objective.scale;
  Eigen::MatrixXd system = s.asDiagonal() * slope.curvature * s.asDiagonal();
  Eigen::VectorXd const diagonal = system.diagonal();
  double const ridge = 1e-12 * std::max(1.0, diagonal.maxCoeff());
  for (Eigen::Index p = 0; p < system.rows(); ++p) system(p, p) += damping * std::max(diagonal(p), 1e-8) + ridge;
  Eigen::VectorXd step = solve_symmetric(system, slope.gradient.cwiseProduct(s));
  if (!step.allFinite()) return Eigen::VectorXd::Zero(s.size());
  double const longest = step.cwiseAbs().maxCoeff();
  if (longest > most_step) step *= most_step / longest;
  return step.cwiseProduct(s);
}

/// One round of one block of climbers.
void climb_once(Objective const& objective, std::vector<Climber*> const& block, Ledger& ledger) {
  std::vector<Slope> const slopes = slopes_of(objective, block, ledger);
  std::vector<Eigen::VectorXd> trials;
  std::vector<double> promised;
  for (std::size_t k = 0; k < block.size(); ++k) {
    for (double const factor : dampings) {
      Eigen::VectorXd const step = damped_step(objective, slopes[k], factor * block[k]->damping);
      trials.push_back(objective.clamp(block[k]->theta + step, block[k]->theta));
      promised.push_back(std::fabs(slopes[k].gradient.dot(trials.back() - block[k]->theta)));
    }
  }
  std::vector<double> const reached = log_density_in_blocks(objective, to_lanes(trials), ledger);
  for (std::size_t k = 0; k < block.size(); ++k) {
    Climber& climber = *block[k];
    climber.curvature = slopes[k].curvature;
    std::size_t const first = k * damping_count;
    std::size_t best = first;
    for (std::size_t i = first; i < first + damping_count; ++i)
      if (reached[i] > reached[best]) best = i;
    double const hope = *std::max_element(promised.begin() + static_cast<std::ptrdiff_t>(first),
                                          promised.begin() + static_cast<std::ptrdiff_t>(first + damping_count));
    if (reached[best] > climber.log_density) {
      climber.theta = trials[best];
      climber.log_density = reached[best];
      climber.damping = std::max(1e-12, climber.damping * dampings[best - first] * 0.3);
    } else {
      climber.damping *= 1e3;
    }
    climber.done = hope < worth_taking || climber.damping > 1e12;
  }
}

std::vector<std::size_t> not_done(std::vector<Climber> const& climbers) {
  std::vector<std::size_t> left;
  for (std::size_t k = 0; k < climbers.size(); ++k)
    if (!climbers[k].done) left.push_back(k);
  return left;
}

}  // namespace

namespace {

std::size_t per_block(Objective const& objective, double lanes) {
  double const rows = std::max(1, objective.target.residual_count());
  return static_cast<std::size_t>(std::max(1.0, std::floor(std::min((1 << 22) / (rows * lanes), 512 / lanes))));
}

}  // namespace

std::size_t climbers_per_block(Objective const& objective) { return per_block(objective, 2 * objective.dimension() + 1); }

std::vector<Slope> slopes_at(Objective const& objective, std::vector<Eigen::VectorXd> const& places, Ledger& ledger) {
  std::size_t const width = per_block(objective, objective.target.derivative_cost());
  std::vector<Slope> slopes;
  for (std::size_t first = 0; first < places.size(); first += width) {
    std::vector<Climber> climbers(std::min(width, places.size() - first));
    std::vector<Climber*> block;
    for (std::size_t k = 0; k < climbers.size(); ++k) {
      climbers[k].theta = places[first + k];
      block.push_back(&climbers[k]);
    }
    for (Slope& slope : slopes_of(objective, block, ledger)) slopes.push_back(std::move(slope));
  }
  return slopes;
}

Slope slope_at(Objective const& objective, Eigen::VectorXd const& theta, Ledger& ledger) {
  return std::move(slopes_at(objective, {theta}, ledger).front());
}

Climber climber_at(Eigen::VectorXd theta, double log_density) { return {std::move(theta), log_density, 1e-2, {}, false}; }

void climb(Objective const& objective, std::vector<Climber>& climbers, int rounds, Ledger& ledger,
           std::function<bool()> const& stop, Journal* journal) {
  if (objective.target.climbs_by_gradient()) return climb_by_gradient(objective, climbers, rounds, ledger, stop, journal);
  std::size_t const width = per_block(objective, objective.target.derivative_cost());
  if (stop && stop()) return;
  ClimbingStep kept(journal, "climb", climbers, ledger);
  if (kept.over()) return;
  for (LoopPlace place = kept.place(); place.round < rounds; place = {place.round + 1, 0, {}}) {
    if (place.active.empty()) place.active = not_done(climbers);
    if (place.active.empty()) break;
    for (; place.first < place.active.size(); place.first += width) {
      if (stop && stop()) return;
      kept.reached(place);
      std::vector<Climber*> block;
      for (std::size_t i = place.first; i < std::min(place.active.size(), place.first + width); ++i)
        block.push_back(&climbers[place.active[i]]);
      climb_once(objective, block, ledger);
    }
  }
  if (stop && stop()) return;
  kept.finish();
}

}  // namespace sysid
