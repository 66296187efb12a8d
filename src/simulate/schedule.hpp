// The data side of a simulation: for one program and one experiment, the rows of uniforms of every step and sample, and which are
// summed.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "data/experiment.hpp"
#include "program/simulation_program.hpp"
#include "simulate/lengths/step_lengths.hpp"
#include "solver/solver.hpp"

namespace sysid {

/// Rows of uniforms of one section, row-major.
struct UniformRows {
  int width = 0;
  std::vector<double> values;
  double const* row(int r) const { return values.data() + static_cast<std::ptrdiff_t>(r) * width; }
};

class Schedule {
 public:
  /// solver: of the method that the program was compiled for, with one substep where that is a map. Needs as many inputs and
  /// channels in the experiment as the program reads.
  Schedule(SimulationProgram const& program, Experiment const& experiment, SolverSettings const& solver);

  int samples() const { return static_cast<int>(experiment_.time.size()); }
  SolverSettings const& solver() const { return solver_; }
  Experiment const& experiment() const { return experiment_; }
  double time(int sample) const { return experiment_.time[static_cast<std::size_t>(sample)]; }
  /// Whether the sample of the channel is summed: its row is scored and it is not missing, or the channel is one of all samples.
  bool summed(int channel, int sample) const;
  /// The same for all samples of a channel, as flags.
  std::uint8_t const* summed(int channel) const { return summed_[static_cast<std::size_t>(channel)].data(); }
  /// The number of summed samples of a channel.
  int count(int channel) const;
  /// Of those in [from, to), of all channels.
  std::vector<double> counts(int from, int to) const;
  /// The first sample from which on all channels are summed up to the last one that is.
  int without_gaps() const;
  /// One past the last sample that is summed in any channel.
  int last_summed() const { return last_summed_; }

  /// Whether what an equation reads, or its rate, jumps at the sample: a solver that remembers earlier steps begins anew there.
  bool jumps(int sample) const;

  /// Step `substep` of the interval after `sample`; fixed steps only.
  double const* step_row(int sample, int substep) const { return steps_.row(sample * solver_.substeps + substep); }
  /// Of the steps, where the method computes something from their length alone; else one for all.
  StepLengths const& lengths() const { return lengths_; }
  double const* prologue_row(int length) const { return prologue_.row(length); }
  double const* start_row() const { return start_.values.data(); }
  double const* carry_row(int sample) const { return carry_.row(sample); }
  double const* observe_row(int channel, int sample) const { return observe_[static_cast<std::size_t>(channel)].row(sample); }
  double const* record_row(int sample) const { return records_.row(sample); }
  double const* record_after_row(int sample) const { return records_after_.row(sample); }
  // The same of an adjoint's sections.
  double const* reverse_step_row(int sample, int substep) const { return reverse_steps_.row(sample * solver_.substeps + substep); }
  double const* reverse_observe_row(int channel, int sample) const {
    return reverse_observe_[static_cast<std::size_t>(channel)].row(sample);
  }
  double const* reverse_start_row() const { return reverse_start_.values.data(); }
  double const* reverse_values_row(int length) const { return reverse_values_.row(length); }
  std::vector<double> const& epilogue_row() const { return epilogue_; }

  /// A leaf within a step: at `stage` of step `substep` of the interval after `sample`.
  double at_step(UniformLeaf const& leaf, int sample, int substep) const;
  /// A leaf at a sample, or `lag` samples before it: rows before the first are the experiment's history. Inputs are read from the
  /// right, `input_rate` at the last sample from the left.
  double at_sample(UniformLeaf const& leaf, int sample) const;

 private:
  using ValueOf = std::function<double(UniformLeaf const& leaf, int row)>;
  static UniformRows tabulate(UniformTable const& table, int rows, ValueOf const& value_of);
  UniformRows tabulate_steps(UniformTable const& table) const;
  UniformRows tabulate_samples(UniformTable const& table, int rows) const;
  UniformRows tabulate_lengths(UniformTable const& table) const;
  double length_of_step(int sample) const {
    return lengths_.values[static_cast<std::size_t>(lengths_.of[static_cast<std::size_t>(sample)])];
  }

  Experiment experiment_;
  SolverSettings solver_;
  StepLengths lengths_;
  bool map_ = false;                               // what a step reads, it reads at its first sample
  std::vector<std::vector<std::uint8_t>> summed_;  // [channels][samples]
  std::vector<int> counts_;
  int last_summed_ = 0;
  UniformRows prologue_, start_, carry_, steps_, records_, records_after_, reverse_steps_, reverse_start_, reverse_values_;
  std::vector<UniformRows> observe_, reverse_observe_;
  std::vector<double> epilogue_;
};

}  // namespace sysid
