// How the states of a block of lanes come from one sample to the next: one strategy per kind of solver.
#pragma once
#include <memory>
#include <optional>

#include "core/numeric/lanes.hpp"
#include "core/system/ledger.hpp"
#include "program/interpreter/executor.hpp"
#include "program/simulation_program.hpp"
#include "simulate/schedule.hpp"

namespace sysid {

/// The register file of a block, as a strategy sees it: executor.width lanes, of which those from `lanes` on are copies of a lane.
struct LaneFile {
  SimulationProgram const& program;
  Schedule const& schedule;
  Executor executor;
  int lanes;
  double* file;       // where code runs
  double* row;        // uniforms of the running section, after the constants
  double* registers;  // rows of executor.stride()
  /// ExecutionOptions::stopped, asked within a step where that can take long; null: never.
  bool (*stopped)() = nullptr;

  Lanes rows(int first, int count) const {
    return {registers + first * executor.stride(), count, executor.width, executor.stride()};
  }
  Lanes states() const { return rows(program.registers.first_state(), program.registers.states); }
  Lanes parameters() const { return rows(0, program.registers.parameters); }
  void load_row(double const* values, int width) const;
};

/// Why a lane could not be brought to the next sample, and where.
struct StepFailure {
  FailureClass kind = FailureClass::non_finite;
  double time = 0;             // [s] after the first sample
  std::optional<NodeId> node;  // of SimulationProgram::source.graph, where it is known
};

/// Belongs to one block, so it may keep what it needs from step to step. A lane's results depend on that lane alone.
class Stepper {
 public:
  virtual ~Stepper() = default;
  /// The states are those of sample 0, the parameters in place; or particles were put there, at any sample, which have no
  /// algebraic states.
  virtual void start() {}
  /// The parameters have changed; the states have not.
  virtual void parameters_changed() {}
  /// From `sample` to the next one. A lane that cannot be brought there gets states that are not finite; so do those that have
  /// not arrived when the caller wants to stop.
  virtual void step(int sample) = 0;
  /// Why a lane's states are not finite, where more is known than that.
  virtual std::optional<StepFailure> failure(int) const { return std::nullopt; }
};

/// The strategy of the schedule's solver.
std::unique_ptr<Stepper> make_stepper(LaneFile const& file);

/// Lane-instructions that one lane takes per sampling interval, roughly: to share the work out.
double work_per_sample(SimulationProgram const& program, Schedule const& schedule);
/// Those of one lane for what its steps take from their lengths, along a record whose steps differ; else 0.
double work_of_lengths(SimulationProgram const& program, Schedule const& schedule);
/// The narrowest block that is worth a thread of its own.
int least_lanes(SolverSettings const& solver);
/// Lanes that cost together hardly more than one of them.
int grain(SolverSettings const& solver);

}  // namespace sysid
