// Restoring forces of the oscillators of a model along an experiment, from trajectories of draws.
#pragma once
#include <span>
#include <vector>

#include "data/experiment.hpp"
#include "likelihood/trajectory.hpp"
#include "report/restoring_force.hpp"

namespace sysid {

/// Of every pair of states q, q' whose acceleration reads nothing of another such pair, neither time nor data, and either one
/// input, in which it is affine with a factor of parameters alone, or none; a model without such a pair has none. quantities,
/// result: of trajectories along the experiment; parameters: those they were run with, SI [parameters x draws].
std::vector<RestoringForce> restoring_forces(Model const& model, std::span<TrajectoryQuantity const> quantities,
                                             Trajectory::Result const& result, ConstLanes parameters, Experiment const& experiment);

/// The second derivative of equidistant samples at sample i, by the parabola of least squares through 2 half_width + 1 of them, as
/// weights:
///
///   D y_i = sum_k w_k y_(i+k) / step^2 = sum_k s_k (y_(i+k+1) - 2 y_(i+k) + y_(i+k-1)) / step^2
///
/// w: [2 half_width + 1]; s: [2 half_width - 1], their sum is 1: what the derivative is smoothed by. half_width >= 2.
struct SecondDifference {
  explicit SecondDifference(int half_width);
  std::vector<double> weights, smoothing;
  /// sd of D y_i for independent noise of sd 1 on the samples and a step of 1.
  double noise = 0;
};

}  // namespace sysid
