// Damped steps across a ridge, several dampings at once.
#include "search/ridge.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "linear_algebra/decompositions.hpp"

namespace sysid {
namespace {

constexpr double tolerated = 4.5;
constexpr int most_rounds = 12;
constexpr std::array dampings = {0.0, 1e-8, 1e-4, 1.0, 1e4};  // of the largest curvature

std::vector<double> log_likelihood(Target const& target, std::vector<Eigen::VectorXd> const& points, Ledger& ledger) {
  std::vector<double> values(points.size());
  target.log_likelihood(to_lanes(points), values, ledger);
  return values;
}

/// Steps from `theta` at right angles to the unit vector `along`, which is in widths of the prior, for each damping.
std::vector<Eigen::VectorXd> steps_across(Objective const& objective, Eigen::VectorXd const& theta, Eigen::VectorXd const& along,
                                          Ledger& ledger) {
  Eigen::Index const n = theta.size();
  auto const dimension = static_cast<int>(n);
  LaneArray gradient(dimension, 1), curvature(dimension * dimension, 1);
  Eigen::VectorXd const apart = difference_width(objective.target) * objective.scale;
  objective.target.gauss_newton(to_lanes({theta}), {apart.data(), static_cast<std::size_t>(n)}, gradient, curvature, ledger);
  Eigen::VectorXd slope(n);
  Eigen::MatrixXd bend(n, n);
  for (int p = 0; p < dimension; ++p) {
    slope(p) = gradient(p, 0) * objective.scale(p);
    for (int q = 0; q < dimension; ++q) bend(p, q) = curvature(p * dimension + q, 0) * objective.scale(p) * objective.scale(q);
  }
  Eigen::MatrixXd const across = Eigen::MatrixXd::Identity(n, n) - along * along.transpose();
  Eigen::VectorXd const slope_across = across * slope;
  Eigen::MatrixXd const bend_across = across * bend * across;
  double const largest = bend_across.diagonal().maxCoeff();
  std::vector<Eigen::VectorXd> steps;
  if (!(largest > 0)) return steps;
  for (double const damping : dampings) {
    // The direction along the ridge is given a curvature of its own, which moves nothing: its slope is zero.
    Eigen::MatrixXd const damped =
        bend_across + largest * (along * along.transpose() + std::max(damping, 1e-14) * Eigen::MatrixXd::Identity(n, n));
    Eigen::VectorXd const step = across * solve_symmetric(damped, slope_across);
    if (step.allFinite()) steps.push_back(step.cwiseProduct(objective.scale));
  }
  return steps;
}

/// Whether the ridge at `from`, beside a place of this log likelihood, is as high.
bool reaches(Objective const& objective, Eigen::VectorXd from, Eigen::VectorXd const& along, double top, Ledger& ledger) {
  double height = log_likelihood(objective.target, {from}, ledger).front();
  for (int round = 0; round < most_rounds && height < top - tolerated; ++round) {
    std::vector<Eigen::VectorXd> places = steps_across(objective, from, along, ledger);
    if (places.empty()) return false;
    for (Eigen::VectorXd& each : places) each = objective.clamp(from + each, from);
    std::vector<double> const heights = log_likelihood(objective.target, places, ledger);
    auto const best = std::max_element(heights.begin(), heights.end());
    if (!(*best > height)) return false;
    height = *best;
    from = places[static_cast<std::size_t>(best - heights.begin())];
  }
  return height >= top - tolerated;
}

}  // namespace

bool is_ridge(Objective const& objective, Eigen::VectorXd const& theta, Eigen::VectorXd const& move, Ledger& ledger) {
  double const top = log_likelihood(objective.target, {theta}, ledger).front();
  Eigen::VectorXd const along = move.cwiseQuotient(objective.scale).normalized();
  return reaches(objective, objective.clamp(theta + move, theta), along, top, ledger) ||
         reaches(objective, objective.clamp(theta - move, theta), along, top, ledger);
}

}  // namespace sysid
