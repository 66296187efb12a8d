// The data side of a simulation: for one program and one experiment, the rows of uniforms of every step and sample, and which are
// summed.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "data/experiment.hpp"
#include "program/simulation_program.hpp"

namespace sysid {

/// Rows of uniforms of one section, row-major.
struct UniformRows {
  int width = 0;
  std::vector<double> values;
  double const* row(int r) const { return values.data() + static_cast<std::ptrdiff_t>(r) * width; }
};

class Schedule {
 public:
  /// substeps >= 1: integrator steps per sampling interval.
  Schedule(SimulationProgram const& program, Experiment const& experiment, int substeps);

  int samples() const { return static_cast<int>(time_.size()); }
  int substeps() const { return substeps_; }
  double time(int sample) const { return time_[static_cast<std::size_t>(sample)]; }
  /// Whether the sample of the channel is summed: its row is scored and it is not missing.
  bool summed(int channel, int sample) const { return summed_[static_cast<std::size_t>(sample * channels_ + channel)] != 0; }
  /// The number of summed samples of a channel.
  int count(int channel) const { return counts_[static_cast<std::size_t>(channel)]; }
  /// One past the last sample that is summed in any channel.
  int last_summed() const { return last_summed_; }

  double const* step_row(int sample, int substep) const { return steps_.row(sample * substeps_ + substep); }
  double const* observe_row(int channel, int sample) const { return observe_[static_cast<std::size_t>(channel)].row(sample); }
  double const* record_row(int sample) const { return records_.row(sample); }
  double const* epilogue_row() const { return epilogue_.data(); }

  /// The value of a uniform leaf, for a scalar re-run: within `substep` of the interval after `sample`.
  double leaf(UniformLeaf const& leaf, int sample, int substep) const;

 private:
  Experiment experiment_;
  std::vector<double> time_;
  int substeps_ = 1;
  int channels_ = 0;
  std::vector<std::uint8_t> summed_;
  std::vector<int> counts_;
  int last_summed_ = 0;
  UniformRows steps_, records_;
  std::vector<UniformRows> observe_;
  std::vector<double> epilogue_;
};

}  // namespace sysid
