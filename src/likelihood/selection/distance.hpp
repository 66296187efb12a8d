// How far a simulation lies from the data: sums over the samples of each channel, put together to one number.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "likelihood/compiled_model.hpp"
#include "simulate/schedule.hpp"

namespace sysid {

/// Per channel over the scored, present samples of all experiments, y* the simulation without noise:
///
///   nmse: 100 / (N var y) sum (y - y*)^2                                                            the tutorial's (8.18)
///   rmse: sqrt(sum (y - y*)^2 / N), in one unit for all channels of all models
///   mean: sum e / N of an expression e >= 0 of the sample and its simulation
///
/// var y is the population variance of the measured samples of an experiment (mean removed); over several experiments the channel's
/// nmse is 100 sum (y - y*)^2 / sum_e N_e var_e. Channels: the mean by their weights.
enum class DistanceKind { nmse, rmse, mean };

struct DistanceMeasure {
  DistanceKind kind = DistanceKind::nmse;
  std::vector<double> weights;                     // per channel of the model, >= 0, not all 0
  double unit = 1;                                 // rmse: its unit in SI
  std::vector<std::optional<NodeId>> expressions;  // `mean`: per channel with a weight, of the model's graph, SI; else empty
};

/// The channel sums of a measure as a program: one sum per channel, each growing from sample to sample.
std::shared_ptr<SimulationProgram const> compile_distance(CompiledModel const& compiled, DistanceMeasure const& measure);

/// The terms of these sums as records, one per channel and sample.
std::shared_ptr<SimulationProgram const> compile_distance_terms(CompiledModel const& compiled, DistanceMeasure const& measure);

/// Turns channel sums into the distance. Grows with each of them, so a part of the sums gives a lower bound.
class Distance {
 public:
  /// UserError E6517 when a channel does not vary in the data: it has no NMSE.
  Distance(Model const& model, DistanceMeasure const& measure, std::span<Schedule const* const> experiments);
  /// sums: per channel, over all experiments, SI.
  double operator()(std::span<double const> sums) const;

  /// The distance that noise alone leaves of a perfect model, in expectation: with independent noise of standard deviation sd[c]
  /// (SI) in channel c. NaN for `mean`.
  double floor(std::span<double const> sd) const;

 private:
  DistanceKind kind_;
  std::vector<double> weight_;  // normalised; 0: takes no part
  std::vector<double> scale_;   // of a channel's sum
  std::vector<int> count_;
};

}  // namespace sysid
