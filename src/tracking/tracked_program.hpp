// A model whose parameters are states: they follow random walks, and a Kalman filter estimates them together with the states of the
// equations. Written as a program that also gives what a test for changes needs of every sample.
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "model/model.hpp"
#include "program/kernel.hpp"
#include "program/moments/moments.hpp"
#include "program/simulation_program.hpp"

namespace sysid {

/// A parameter that is tracked: on the unbounded scale on which a sampler moves it, so that it stays between its bounds.
struct TrackedParameter {
  int parameter = 0;                   // of the model
  std::optional<double> lower, upper;  // SI
  bool logarithmic = false;            // between the logarithms of two bounds
};

/// Vectors of `size` are the states of the model, then the tracked parameters on their unbounded scales.
struct TrackedProgram {
  /// Parameters: the intensities of the random walks [tracked]; what the noise variance of each channel is multiplied by
  /// [channels]; the moments at the first sample [moments].
  std::shared_ptr<SimulationProgram const> program;
  Kernel values;  // unbounded [tracked] -> SI values [tracked], then their slopes [tracked]
  int states = 0, tracked = 0;
  int size() const { return states + tracked; }
  /// Means [size], then the covariances that may differ from 0: what the program moves and corrects.
  int moments = 0;
  std::vector<int> covariance;  // [size x size] the moment that is the covariance of two entries, -1: it is 0
  int place(int i, int j) const { return covariance[static_cast<std::size_t>(i * size() + j)]; }

  // Records of a sample, by their first.
  int records = 0;
  int after = 0;       // [moments] once the sample has corrected them
  int transition = 0;  // [states x size] d(states here)/d(entries at the sample before)
  /// NaN where the sample is missing. Gains: how much an entry moves by a unit of the innovation.
  struct Channel {
    int innovation, variance, slopes, gains;  // 1, 1, [size], [size]
  };
  std::vector<Channel> channels;
};

/// model: without processes, unknowns and memories, its noise normal without bounds. values: of all its parameters, SI; those that
/// are not tracked stay there.
TrackedProgram compile_tracking(Model const& model, std::span<double const> values, std::span<TrackedParameter const> tracked,
                                std::string const& method, MomentRule rule);

}  // namespace sysid
