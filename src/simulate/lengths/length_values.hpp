// What a block of lanes computes from parameters and the length of a step: kept for each length, since the steps of a record may
// differ.
#pragma once
#include <functional>
#include <vector>

#include "native/loop.hpp"
#include "program/interpreter/executor.hpp"
#include "program/simulation_program.hpp"

namespace sysid {

/// Of one block. Nothing is done along a record whose steps are all of one length.
class LengthValues {
 public:
  /// run: a section, with the uniforms of that length.
  using Run = std::function<void(Section const& section, int length)>;

  /// Machine code for the values of a length alone (native::LoopKind::values); a null function: the prologue is interpreted.
  struct Machine {
    native::Function function = nullptr;
    int lanes = 1;                 // of its vector
    double const* rows = nullptr;  // of the prologue, one per length
  };

  /// registers: rows of executor.stride(), of the block. Outlives none of them.
  LengthValues(SimulationProgram const& program, Executor executor, double* registers, int lengths, Run run, Machine machine);

  /// The prologue has been run for new parameters, with the first length.
  void parameters_changed();
  /// Registers have come from elsewhere.
  void registers_changed();
  /// Brings the values of this length into their registers.
  void take(int length);

  /// Whether values of this length are kept: which ones does not depend on the lanes, as the order of sums must not.
  bool keeps(int length) const { return length < static_cast<int>(kept_.size()); }

  /// With an adjoint: the derivatives by values of every length are 0.
  void start_reverse();
  /// A step has been gone back over. Derivatives by values that are not kept are passed on to the parameters.
  void step_reversed();
  /// Those that have been gathered are passed on to the parameters.
  void finish_reverse();

 private:
  /// What is kept of a length.
  struct Kept {
    std::vector<double> values, slopes;  // empty: none
  };
  double* row(int r) const { return registers_ + r * executor_.stride(); }
  Kept* kept(int length) { return length >= 0 && keeps(length) ? &kept_[static_cast<std::size_t>(length)] : nullptr; }
  void compute(int length);
  bool compute_by_machine(int length);
  void put_away_slopes();
  void take_slopes(int length);
  void pass_on_slopes();
  int first_slope() const;
  int slopes() const;

  SimulationProgram const& program_;
  Executor executor_;
  double* registers_;
  Run run_;
  int lengths_;
  Machine machine_;
  std::vector<double> inputs_, outputs_;  // of the machine code
  int current_ = 0;                       // whose values are in the registers; -1: not known
  int computed_ = 0;                      // by the prologue, the last time
  bool backwards_ = false;
  std::vector<Kept> kept_;  // of the most frequent lengths
};

}  // namespace sysid
