// Levenberg-Marquardt in coordinates that the curvature scales.
#include "search/improper/free_climb.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "linear_algebra/decompositions.hpp"

namespace sysid::unbounded {
namespace {

constexpr std::array dampings = {0.0, 0.1, 1.0, 10.0, 100.0};
constexpr double worth_taking = 1e-6;  // nats
constexpr double longest = 4.6;        // of a logarithm

/// On a line the size of the value is all that is known of a coordinate's width.
Objective sized(Objective objective, Eigen::VectorXd const& theta) {
  for (Eigen::Index p = 0; p < theta.size(); ++p)
    if (objective.target.parameters()[static_cast<std::size_t>(p)].improper == Improper::line)
      objective.scale(p) = std::max(std::fabs(theta(p)), 1e-12 * objective.scale(p));
  return objective;
}

/// By differences over a thousandth of the widths of each place.
void add_prior(Objective const& objective, std::vector<Eigen::VectorXd> const& places, std::vector<Slope>& slopes) {
  if (objective.objective_kind == ObjectiveKind::likelihood) return;
  std::vector<Eigen::VectorXd> points, steps;
  for (Eigen::VectorXd const& place : places) {
    points.push_back(place);
    steps.push_back(1e-3 * sized(objective, place).scale);
    for (Eigen::Index p = 0; p < place.size(); ++p)
      for (double const sign : {1.0, -1.0}) {
        points.push_back(place);
        points.back()(p) += sign * steps.back()(p);
      }
  }
  std::vector<double> const value = objective.log_prior(to_lanes(points));
  std::size_t next = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    double const at = value[next++];
    for (Eigen::Index p = 0; p < places[k].size(); ++p, next += 2) {
      double const h = steps[k](p), slope = (value[next] - value[next + 1]) / (2 * h),
                   bend = (2 * at - value[next] - value[next + 1]) / (h * h);
      if (std::isfinite(slope)) slopes[k].gradient(p) += slope;
      if (std::isfinite(bend) && bend > 0) slopes[k].curvature(p, p) += bend;
    }
  }
}

Eigen::VectorXd damped_step(Objective const& objective, Slope const& slope, int held, double damping) {
  Eigen::Index const n = slope.gradient.size();
  Eigen::VectorXd root = slope.curvature.diagonal().cwiseMax(0.0).cwiseSqrt();
  if (held >= 0) root(held) = 0;
  std::vector<Eigen::Index> free;
  for (Eigen::Index p = 0; p < n; ++p)
    if (root(p) > 0 && std::isfinite(root(p)) && std::isfinite(slope.gradient(p))) free.push_back(p);
  Eigen::VectorXd step = Eigen::VectorXd::Zero(n);
  if (free.empty()) return step;
  auto const m = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd system(m, m);
  Eigen::VectorXd side(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    side(i) = slope.gradient(free[static_cast<std::size_t>(i)]) / root(free[static_cast<std::size_t>(i)]);
    for (Eigen::Index j = 0; j < m; ++j) {
      Eigen::Index const a = free[static_cast<std::size_t>(i)], b = free[static_cast<std::size_t>(j)];
      system(i, j) = slope.curvature(a, b) / root(a) / root(b);
    }
    system(i, i) += damping + 1e-13;
  }
  Eigen::VectorXd const scaled = solve_symmetric(system, side);
  if (!scaled.allFinite()) return step;
  double shorter = 1;
  for (Eigen::Index i = 0; i < m; ++i) {
    Eigen::Index const p = free[static_cast<std::size_t>(i)];
    step(p) = scaled(i) / root(p);
    if (objective.target.parameters()[static_cast<std::size_t>(p)].improper == Improper::half_line)
      shorter = std::min(shorter, longest / std::max(longest, std::fabs(step(p))));
  }
  return shorter * step;
}

void climb_once(Objective const& objective, std::vector<FreeClimber*> const& block, Ledger& ledger) {
  std::vector<Eigen::VectorXd> places, trials;
  for (FreeClimber const* each : block) places.push_back(each->theta);
  std::vector<Slope> slopes = free_slopes(objective, places, ledger);
  std::vector<double> promised;
  for (std::size_t k = 0; k < block.size(); ++k)
    for (double const factor : dampings) {
      Eigen::VectorXd const step = damped_step(objective, slopes[k], block[k]->held, factor * block[k]->damping);
      trials.push_back(places[k] + step);
      promised.push_back(std::fabs(slopes[k].gradient.dot(step)));
    }
  std::vector<double> const reached = log_density_in_blocks(objective, to_lanes(trials), ledger);
  for (std::size_t k = 0; k < block.size(); ++k) {
    FreeClimber& climber = *block[k];
    climber.curvature = std::move(slopes[k].curvature);
    auto const first = reached.begin() + static_cast<std::ptrdiff_t>(k * dampings.size());
    auto const best = std::max_element(first, first + static_cast<std::ptrdiff_t>(dampings.size()));
    double hope = 0;
    for (std::size_t i = 0; i < dampings.size(); ++i) hope = std::max(hope, promised[k * dampings.size() + i]);
    if (*best > climber.log_density) {
      climber.theta = trials[static_cast<std::size_t>(best - reached.begin())];
      climber.log_density = *best;
      climber.damping = std::max(1e-12, 0.3 * climber.damping * std::max(dampings[static_cast<std::size_t>(best - first)], 0.1));
    } else {
      climber.damping *= 1e3;
    }
    climber.done = hope < worth_taking || climber.damping > 1e9;
  }
}

}  // namespace

std::vector<Slope> free_slopes(Objective const& objective, std::vector<Eigen::VectorXd> const& places, Ledger& ledger) {
  Objective likelihood = objective;
  likelihood.objective_kind = ObjectiveKind::likelihood;
  std::vector<Slope> slopes;
  if (objective.target.derivatives() == DerivativeSource::exact)
    slopes = slopes_at(likelihood, places, ledger);
  else
    for (Eigen::VectorXd const& each : places) slopes.push_back(slope_at(sized(likelihood, each), each, ledger));
  add_prior(objective, places, slopes);
  return slopes;
}

void climb_freely(Objective const& objective, std::vector<FreeClimber>& climbers, int rounds, Ledger& ledger,
                  std::function<bool()> const& stop) {
  std::size_t const width = climbers_per_block(objective);
  for (int round = 0; round < rounds; ++round) {
    std::vector<FreeClimber*> active;
    for (FreeClimber& each : climbers)
      if (!each.done && std::isfinite(each.log_density)) active.push_back(&each);
    if (active.empty()) return;
    for (std::size_t first = 0; first < active.size(); first += width) {
      if (stop && stop()) return;
      climb_once(objective,
                 {active.begin() + static_cast<std::ptrdiff_t>(first),
                  active.begin() + static_cast<std::ptrdiff_t>(std::min(active.size(), first + width))},
                 ledger);
    }
  }
}

}  // namespace sysid::unbounded
