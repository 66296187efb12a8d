// One block of lanes on its way through the schedule. State and accumulators stay in its register file between calls, so a run may
// stop anywhere, be looked at, lose its dead lanes and go on.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "core/numeric/lanes.hpp"
#include "program/interpreter/executor.hpp"
#include "program/simulation_program.hpp"
#include "simulate/schedule.hpp"
#include "simulate/stepper.hpp"

namespace sysid {

class Block {
 public:
  /// lanes <= executor.width; what the executor has more computes copies of the last lane.
  Block(SimulationProgram const& program, Schedule const& schedule, Executor executor, int lanes);

  /// Takes parameters [parameters x lanes] and computes what hangs on them; then the initial states, with empty accumulators.
  void set_parameters(ConstLanes parameters);
  void start();
  /// From `sample` to the next one.
  void step(int sample);
  /// Adds the sample to the accumulators of the channels it is summed in.
  void observe(int sample);
  /// Computes the records of the sample; read them with `records`.
  void record(int sample);
  /// Computes the sums from the accumulators; read them with `sums`.
  void finish();

  /// Takes up lanes that were put down: all that a fixed-step solver carries from sample to sample, [RegisterLayout::carried x
  /// lanes].
  void load(ConstLanes registers);
  void store(Lanes registers) const;

  /// Notes which lanes have a state that is not finite; they go on as copies of a live one. Returns whether any lane lives.
  bool bury(int sample);

  ConstLanes states() const { return rows(program_.registers.first_state(), program_.registers.states); }
  ConstLanes records() const { return rows(program_.registers.first_record(), program_.registers.records); }
  ConstLanes accumulators() const { return rows(program_.registers.first_accumulator(), program_.registers.accumulators); }
  ConstLanes sums() const { return rows(program_.registers.first_sum(), program_.registers.sums); }
  /// The sample at which a lane was found dead; -1: it lives.
  std::vector<int> const& death() const { return death_; }
  /// Why a dead lane died.
  FailureClass failure(int lane) const {
    auto const known = stepper_->failure(lane);
    return known ? known->kind : FailureClass::non_finite;
  }
  /// What the solver knows of it.
  std::optional<StepFailure> step_failure(int lane) const { return stepper_->failure(lane); }

 private:
  ConstLanes rows(int first, int count) const { return file_.rows(first, count).columns(0, lanes_); }
  SimulationProgram const& program_;
  Schedule const& schedule_;
  Executor executor_;
  int lanes_;
  LaneArray memory_;
  LaneFile file_;
  std::unique_ptr<Stepper> stepper_;
  std::vector<int> death_;
};

}  // namespace sysid
