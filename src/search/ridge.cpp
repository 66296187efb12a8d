// Damped steps across a ridge, several dampings at once.
#include "search/ridge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "linear_algebra/decompositions.hpp"
#include "search/descent.hpp"

namespace sysid {
namespace {

constexpr double tolerated = 4.5;
constexpr int most_steps = 12, of_short_move = 4;                  // back to the ridge
constexpr std::array step_dampings = {0.0, 1e-8, 1e-4, 1.0, 1e4};  // of the largest curvature

/// Steps from `theta` at right angles to the unit vector `along`, which is in widths of the prior, for each damping.
std::vector<Eigen::VectorXd> steps_across(Objective const& likelihood, Eigen::VectorXd const& theta, Eigen::VectorXd const& along,
                                          Ledger& ledger) {
  Eigen::Index const n = theta.size();
  auto const [gradient, curvature] = slope_at(likelihood, theta, ledger);
  Eigen::VectorXd const slope = gradient.cwiseProduct(likelihood.scale);
  Eigen::MatrixXd const bend = likelihood.scale.asDiagonal() * curvature * likelihood.scale.asDiagonal();
  Eigen::MatrixXd const across = Eigen::MatrixXd::Identity(n, n) - along * along.transpose();
  Eigen::VectorXd const slope_across = across * slope;
  Eigen::MatrixXd const bend_across = across * bend * across;
  double const largest = bend_across.diagonal().maxCoeff();
  std::vector<Eigen::VectorXd> steps;
  if (!(largest > 0)) return steps;
  for (double const damping : step_dampings) {
    // The direction along the ridge is given a curvature of its own, which moves nothing: its slope is zero.
    Eigen::MatrixXd const damped =
        bend_across + largest * (along * along.transpose() + std::max(damping, 1e-14) * Eigen::MatrixXd::Identity(n, n));
    Eigen::VectorXd const step = across * solve_symmetric(damped, slope_across);
    if (step.allFinite()) steps.push_back(step.cwiseProduct(likelihood.scale));
  }
  return steps;
}

/// Where the ridge at `from`, beside a place of this log likelihood, is as high; nothing if it is not.
std::optional<Eigen::VectorXd> top_beside(Objective const& likelihood, Eigen::VectorXd from, Eigen::VectorXd const& along,
                                          double top, int rounds, Ledger& ledger) {
  double height = likelihood.log_density(to_lanes({from}), ledger).front();
  for (int round = 0; round < rounds && height < top - tolerated; ++round) {
    std::vector<Eigen::VectorXd> places = steps_across(likelihood, from, along, ledger);
    if (places.empty()) return std::nullopt;
    for (Eigen::VectorXd& each : places) each = likelihood.clamp(from + each, from);
    std::vector<double> const heights = likelihood.log_density(to_lanes(places), ledger);
    auto const best = std::max_element(heights.begin(), heights.end());
    if (!(*best > height)) return std::nullopt;
    height = *best;
    from = places[static_cast<std::size_t>(best - heights.begin())];
  }
  if (height < top - tolerated) return std::nullopt;
  return from;
}

/// The likelihood alone, with its height where the ridge begins.
struct Ridge {
  Objective likelihood;
  Eigen::VectorXd const& theta;
  double top;

  Ridge(Objective const& objective, Eigen::VectorXd const& from, Ledger& ledger) : likelihood(objective), theta(from) {
    likelihood.objective_kind = ObjectiveKind::likelihood;
    top = likelihood.log_density(to_lanes({theta}), ledger).front();
  }
  Eigen::VectorXd direction(Eigen::VectorXd const& move) const { return move.cwiseQuotient(likelihood.scale).normalized(); }
  std::optional<Eigen::VectorXd> beside(Eigen::VectorXd const& place, Eigen::VectorXd const& move, int rounds,
                                        Ledger& ledger) const {
    return top_beside(likelihood, likelihood.clamp(place + move, place), direction(move), top, rounds, ledger);
  }
};

bool reaches(Ridge const& ridge, Eigen::VectorXd const& move, Ledger& ledger) {
  return ridge.beside(ridge.theta, move, most_steps, ledger).has_value();
}

/// Whether the ridge goes on to the end of the move, or bends away from it by more than priors are wide: a p q that is known ends,
/// along p, where q does. In steps that get shorter where the ridge bends more. A prior that falls along the ridge ends it.
bool goes_on(Objective const& objective, Ridge const& ridge, Eigen::VectorXd const& move, Ledger& ledger) {
  constexpr double longest = 1.0 / 8, shortest = longest / 16384, bent = 3;  // bent: widths of the prior
  constexpr int most_tries = 40;
  bool const has_prior = objective.objective_kind != ObjectiveKind::likelihood;
  double const top = has_prior ? objective.log_density(to_lanes({ridge.theta}), ledger).front() : 0;
  Eigen::VectorXd place = ridge.theta;
  double at = 0, step = longest;
  for (int tried = 0; tried < most_tries && at < 1; ++tried) {
    auto const next = ridge.beside(place, step * move, of_short_move, ledger);
    if (!next) {
      step /= 2;
      if (step < shortest) return false;
      continue;
    }
    place = *next;
    at += step;
    if (has_prior && objective.log_density(to_lanes({place}), ledger).front() < top - tolerated) return false;
    Eigen::VectorXd const off = (place - ridge.theta - at * move).cwiseQuotient(ridge.likelihood.scale);
    if (off.cwiseAbs().maxCoeff() > bent) return true;
  }
  return at >= 1;
}

}  // namespace

bool is_ridge(Objective const& objective, Eigen::VectorXd const& theta, Eigen::VectorXd const& move, Ledger& ledger) {
  Ridge const ridge(objective, theta, ledger);
  return reaches(ridge, move, ledger) || reaches(ridge, -move, ledger);
}

bool is_ridge_both_ways(Objective const& objective, Eigen::VectorXd const& theta, Eigen::VectorXd const& move, Ledger& ledger) {
  Ridge const ridge(objective, theta, ledger);
  return goes_on(objective, ridge, move, ledger) && goes_on(objective, ridge, -move, ledger);
}

}  // namespace sysid
