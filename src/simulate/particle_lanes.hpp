// Particles: many lanes of one parameter vector that differ in their states alone. The states stand side by side in memory and pass
// through one block of lanes, so that they may be weighed, chosen among and changed from sample to sample.
#pragma once
#include <span>

#include "core/numeric/lanes.hpp"
#include "simulate/block.hpp"
#include "simulate/simulator.hpp"

namespace sysid {

/// Particle w is the same bytes whatever the lanes and the executor: lanes depend on their own column alone.
class ParticleLanes {
 public:
  ParticleLanes(Simulator const& simulator, int count);

  int count() const { return count_; }
  /// Initial states. shared [.. x 1]: the first parameters; own [.. x count]: the others, which only initial states may read.
  void start(ConstLanes shared, ConstLanes own);
  /// From `sample` to the next one. A solver that remembers earlier steps begins anew.
  void step(int sample);
  /// Of the fixed steps from `sample` to the next one, one alone.
  void step(int sample, int substep);
  /// The records of a sample [records x count]; until the next call.
  ConstLanes record(int sample);
  /// [states x count]; may be changed between calls.
  Lanes states() { return states_.view().columns(0, count_); }
  /// Particle w becomes what particle from[w] was, in the rows [first, end) of its states.
  void select(std::span<int const> from, int first, int end);

 private:
  Lanes of_block(LaneArray& all, int first) const { return all.view().columns(first, width_); }
  void take_back(int first);
  template <class Step>
  void move(Step const& step);

  Simulator const& simulator_;
  int count_;
  Executor executor_;
  int width_;  // particles in a block
  Block block_;
  LaneArray states_, records_;  // for whole blocks; what is beyond `count` means nothing
  std::vector<double> chosen_;
};

}  // namespace sysid
