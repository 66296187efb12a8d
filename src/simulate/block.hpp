// One block of lanes on its way through the schedule. State and accumulators stay in its register file between calls, so a run may
// stop anywhere, be looked at, lose its dead lanes and go on.
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/numeric/lanes.hpp"
#include "native/machine_code.hpp"
#include "program/interpreter/executor.hpp"
#include "program/simulation_program.hpp"
#include "simulate/lengths/length_values.hpp"
#include "simulate/schedule.hpp"
#include "simulate/stepper.hpp"

namespace sysid {

class Block {
 public:
  /// lanes <= executor.width; what the executor has more computes copies of the last lane.
  /// Machine code is compiled here where the executor wants it and it is not there yet. stopped: as ExecutionOptions has it.
  Block(SimulationProgram const& program, Schedule const& schedule, Executor executor, int lanes,
        native::LoopKind loop = native::LoopKind::observe, bool (*stopped)() = nullptr);

  Executor const& executor() const { return executor_; }

  /// Takes parameters [parameters x lanes] and computes what hangs on them; then the initial states, with empty accumulators.
  void set_parameters(ConstLanes parameters);
  void start();
  /// From `sample` to the next one.
  void step(int sample);
  /// Of the fixed steps from `sample` to the next one, one alone; in their order, from 0 on.
  void step(int sample, int substep);
  /// Adds samples [from, to) to the accumulators of the channels they are summed in, and steps from each that is before `step_to`
  /// to the next one.
  void advance(int from, int to, int step_to);
  /// Writes the records of samples [from, to) to `out` [(to - from) * records x lanes], a sample after the other, and steps between
  /// them.
  void record(int from, int to, Lanes out);
  /// From sample `from` to sample `to`, past samples [from, to).
  void step_to(int from, int to);
  /// What a sample that is neither recorded nor summed does to the states, where samples correct them.
  void pass(int sample);
  /// Computes the sums from the accumulators; read them with `sums`. The states stay as they are.
  void finish();
  /// The same where so many samples of each channel have been summed so far; of programs without sums of data alone.
  void finish(std::span<double const> counts);

  // With a program that has an adjoint, and the loop `tape`:
  /// As `advance`, and the states before each step go to `tape`: substeps x states x executor.width for each sample, and one more
  /// of the last. look: whether samples are added to the accumulators; if not, they have been.
  void advance_to_tape(int from, int to, int step_to, bool look, double* tape);
  /// Back over samples [from, to) of such a tape, from the last to the first: over the steps from each that is before `step_to`,
  /// then over what is summed of it.
  void reverse(int from, int to, int step_to, double const* tape);
  /// Derivatives of the sums by the states and by the parameters of `adjoint_by` become 0; at the end they are completed by what
  /// the initial states depend on.
  void start_reverse();
  void finish_reverse();
  ConstLanes slopes() const { return rows(program_.registers.first_slope(), program_.registers.slopes); }
  /// Doubles that a sample takes on the tape.
  std::size_t tape_row() const;
  /// Goes on from these states [states x executor.width], which were those of a sample before.
  void put_states(double const* states);
  void copy_states(double* to) const;
  /// Goes on from these states [states x lanes], which may be anybody's at that sample: a solver that remembers earlier steps
  /// begins anew.
  void take_states(ConstLanes states);
  /// The same of one lane, by a method with fixed steps; its accumulators become empty.
  void enter(int lane, std::span<double const> states);

  /// Whether many samples are one call of machine code.
  bool runs_loops() const { return (observe_loop_ != nullptr || record_loop_ != nullptr) && fixed_step(); }

  /// Takes up lanes that were put down: all that a fixed-step solver carries from sample to sample, [RegisterLayout::carried x
  /// lanes].
  void load(ConstLanes registers);
  void store(Lanes registers) const;

  /// Notes which lanes have a state that is not finite; they go on as copies of a live one. Returns whether any lane lives.
  bool bury(int sample);

  ConstLanes states() const { return rows(program_.registers.first_state(), program_.registers.states); }
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
  bool fixed_step() const { return schedule_.solver().fixed_step(); }
  bool all_live_and_finite() const;
  void carry(int sample);
  void observe(int sample);
  void reverse_interpreted(int sample, bool step, double const* tape);
  void record_interpreted(int from, int to, Lanes out);
  /// Brings what hangs on the length of the step from `sample` to where the step reads it.
  void take_length(int sample);
  /// Parts [a, b) of samples [from, to), in their order, from which all steps are of one length, whose values are in place.
  template <class Action>
  void in_parts(int from, int to, Action const& action);
  void correct_recorded(int sample);
  /// What the call leaves open becomes that of the schedule.
  void call(native::Function function, native::Call call) const;
  SimulationProgram const& program_;
  Schedule const& schedule_;
  Executor executor_;
  int lanes_;
  LaneArray memory_;
  LaneFile file_;
  std::unique_ptr<Stepper> stepper_;
  LengthValues length_values_;
  std::vector<int> death_;
  native::Function observe_loop_ = nullptr, record_loop_ = nullptr, reverse_loop_ = nullptr;  // null: interpreted
  LaneArray recorded_;  // by machine code, for all lanes of the executor
};

}  // namespace sysid
