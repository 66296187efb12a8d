// Damped steps, and the covariance at their end.
#include "likelihood/segments/shooting.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/numeric/elementary.hpp"
#include "likelihood/segments/arrowhead.hpp"
#include "likelihood/segments/coefficient_prior.hpp"
#include "likelihood/segments/damping.hpp"
#include "likelihood/segments/segment_differences.hpp"
#include "likelihood/segments/segment_noise.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid {
namespace {

constexpr double rough = 1000;         // gains that are not met by this many times the smallest are the solver's roughness
constexpr double same_columns = 1e-9;  // what is left of a coefficient's column once the others have explained theirs

bool all_finite(std::vector<SegmentSlopes> const& slopes) {
  return std::all_of(slopes.begin(), slopes.end(),
                     [](SegmentSlopes const& each) { return each.finite() && each.by_coefficient.allFinite(); });
}

ShootingPoint moved(ShootingPoint point, ShootingMove const& move) {
  point.coefficients += move.coefficients;
  point.starts += move.starts;
  return point;
}

/// Of the starts: each has a prior worth one sample.
double start_penalty(SegmentSimulation const& simulation) {
  double sum = 0;
  for (int s = 0; s < static_cast<int>(simulation.segments().size()); ++s)
    sum += elementary::log(1.0 + simulation.samples_of_segment(s));
  return simulation.states() / 2.0 * sum;
}

/// What is known at the optimum beside the point.
void describe(SegmentSimulation const& simulation, std::vector<SegmentSlopes> const& slopes, ShootingFit& fit) {
  Eigen::Index const k = simulation.coefficients();
  fit.finite = true;
  fit.squares = squares_of(simulation, slopes);
  fit.log_likelihood = log_likelihood_of(simulation, fit.squares);
  fit.noise_sd = noise_of(simulation, fit.squares,
                          static_cast<double>(k) + static_cast<double>(simulation.states()) * static_cast<double>(slopes.size()));
  std::vector<SegmentSlopes> const all = weighted(simulation, slopes, fit.noise_sd);
  Arrowhead const reduced = reduce(all, 0);
  for (EliminatedSegment const& each : reduced.segments)
    fit.follows.push_back(simulation.states() == 0 ? Eigen::MatrixXd(0, k) : each.follows());
  Eigen::VectorXd norms = Eigen::VectorXd::Zero(k);
  for (SegmentSlopes const& each : all) norms += each.by_coefficient.colwise().squaredNorm().transpose();
  Eigen::MatrixXd const upper = reduced.triangle.topLeftCorner(k, k);
  for (Eigen::Index j = 0; j < k; ++j)
    fit.determined = fit.determined && std::abs(upper(j, j)) > same_columns * std::sqrt(norms(j)) && norms(j) > 0;
  if (k == 0 || !fit.determined) {
    fit.covariance = Eigen::MatrixXd::Constant(k, k, std::numeric_limits<double>::quiet_NaN());
    fit.log_evidence = fit.determined ? fit.log_likelihood - start_penalty(simulation) : -std::numeric_limits<double>::infinity();
    return;
  }
  fit.log_evidence =
      fit.log_likelihood - start_penalty(simulation) +
      log_coefficient_weight(fit.point.coefficients, upper, signal_of(simulation, fit.noise_sd), simulation.others());
  Eigen::MatrixXd const inverse = solve_upper(upper, Eigen::MatrixXd::Identity(k, k));
  fit.covariance = inverse * inverse.transpose();
}

}  // namespace

ShootingFit fit_by_shooting(SegmentSimulation const& simulation, ShootingPoint from, ShootingOptions const& options) {
  ShootingFit fit;
  fit.point = std::move(from);
  SegmentDifferences differences(simulation, fit.point);
  std::vector<SegmentSlopes> slopes = differences.at(fit.point, most_probes);
  if (!all_finite(slopes)) return fit;
  double reached = log_likelihood_of(simulation, squares_of(simulation, slopes));
  Damping damping;
  for (fit.rounds = 0; fit.rounds < options.most_rounds; ++fit.rounds) {
    if (options.interrupted && options.interrupted()) {
      fit.interrupted = true;
      return fit;
    }
    std::vector<SegmentSlopes> const here = weighted(simulation, slopes, noise_of(simulation, squares_of(simulation, slopes), 0));
    ShootingMove const move = move_of(here, reduce(here, damping.value()));
    if (!(move.gain >= 0)) break;  // beyond what the numbers can say
    if (move.gain < options.gain) {
      if (damping.value() <= Damping::first) {
        fit.converged = true;
        break;
      }
      damping.less();
      continue;
    }
    ShootingPoint const trial = moved(fit.point, move);
    std::vector<SegmentSlopes> there = differences.at(trial, 1);
    double const value =
        all_finite(there) ? log_likelihood_of(simulation, squares_of(simulation, there)) : -std::numeric_limits<double>::infinity();
    if (value >= reached) {
      damping.less();
      fit.point = trial;
      slopes = std::move(there);
      reached = value;
    } else {
      fit.converged = move.gain < rough * options.gain;
      damping.more();
      if (fit.converged || damping.exhausted()) break;
    }
  }
  describe(simulation, slopes, fit);
  return fit;
}

}  // namespace sysid
