// States travel between the register file and one lane's solver, sample by sample.
#include "simulate/lane_solver.hpp"

#include <algorithm>
#include <limits>

namespace sysid {

LaneSolvers::LaneSolvers(LaneFile const& file, Make const& make)
    : file_(file),
      equations_(file.program, file.schedule),
      lanes_(static_cast<std::size_t>(file.lanes)),
      states_(static_cast<std::size_t>(file.program.registers.states)) {
  for (Lane& lane : lanes_) lane.solver = make(equations_, file.schedule.solver(), file.stopped);
}

void LaneSolvers::load(int lane) {
  Lanes const states = file_.states();
  for (int s = 0; s < states.rows(); ++s) states_[static_cast<std::size_t>(s)] = states(s, lane);
  equations_.set_parameters(file_.parameters(), lane);
}

void LaneSolvers::store(int lane) {
  Lanes const states = file_.states();
  bool const failed = lanes_[static_cast<std::size_t>(lane)].failure.has_value();
  // What the block has more than lanes are copies of the last one.
  int const end = lane + 1 == file_.lanes ? file_.executor.width : lane + 1;
  for (int s = 0; s < states.rows(); ++s)
    for (int w = lane; w < end; ++w)
      states(s, w) = failed ? std::numeric_limits<double>::quiet_NaN() : states_[static_cast<std::size_t>(s)];
}

void LaneSolvers::make_consistent(int sample) {
  sample_ = sample;
  if (equations_.states() == equations_.differential()) return;
  equations_.set_interval(sample);
  for (int w = 0; w < file_.lanes; ++w) {
    Lane& lane = lanes_[static_cast<std::size_t>(w)];
    if (lane.failure) continue;
    load(w);
    lane.failure = lane.solver->make_consistent(equations_.time(sample), states_);
    store(w);
  }
}

void LaneSolvers::start() {
  for (Lane& lane : lanes_) lane.failure.reset(), lane.fresh = true;
  make_consistent(0);
}

void LaneSolvers::parameters_changed() {
  for (Lane& lane : lanes_) lane.fresh = true;
  if (sample_ >= 0) make_consistent(sample_);
}

void LaneSolvers::step(int sample) {
  // What is remembered, and what samples correct, jumps at every sample.
  SimulationSource const& source = file_.program.source;
  bool const jump = file_.schedule.jumps(sample) || !source.memories.empty() || source.corrects();
  equations_.set_interval(sample);
  for (int w = 0; w < file_.lanes; ++w) {
    Lane& lane = lanes_[static_cast<std::size_t>(w)];
    if (lane.failure) continue;
    load(w);
    if (stopped()) {
      lane.failure = StepFailure{FailureClass::step_limit, equations_.time(sample), std::nullopt};
      store(w);
      continue;
    }
    lane.solver->enter(equations_.time(sample), equations_.time(sample + 1), states_);
    if (lane.fresh || jump) lane.failure = lane.solver->restart(equations_.time(sample), states_);
    lane.fresh = false;
    if (!lane.failure) lane.failure = lane.solver->advance(equations_.time(sample + 1), states_);
    store(w);
  }
  make_consistent(sample + 1);
}

}  // namespace sysid
