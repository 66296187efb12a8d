// The loop body of every simulation: copy a row of uniforms, run the section.
#include "simulate/block.hpp"

#include <algorithm>
#include <cmath>

namespace sysid {

Block::Block(SimulationProgram const& program, Schedule const& schedule, Executor executor, int lanes)
    : program_(program),
      schedule_(schedule),
      executor_(executor),
      lanes_(lanes),
      memory_(1, uniform_space(program.uniforms) + program.registers.total() * executor.stride()),
      file_{program,
            schedule,
            executor,
            lanes,
            memory_.view().data(),
            memory_.view().data() + program.constants.size(),
            memory_.view().data() + uniform_space(program.uniforms)},
      stepper_(make_stepper(file_)),
      death_(static_cast<std::size_t>(lanes), -1) {
  std::copy(program.constants.begin(), program.constants.end(), file_.file);
}

void Block::set_parameters(ConstLanes parameters) {
  for (int r = 0; r < program_.registers.parameters; ++r) {
    double* const row = file_.registers + r * executor_.stride();
    for (int w = 0; w < executor_.width; ++w) row[w] = parameters(r, std::min(w, lanes_ - 1));
  }
  run(*program_.prologue.linked, executor_, file_.file);
  stepper_->parameters_changed();
}

void Block::start() {
  file_.load_row(schedule_.start_row(), program_.start.uniforms.kernel.outputs);
  run(*program_.start.linked, executor_, file_.file);
  double* const accumulators = file_.registers + program_.registers.first_accumulator() * executor_.stride();
  std::fill(accumulators, accumulators + program_.registers.accumulators * executor_.stride(), 0.0);
  std::fill(death_.begin(), death_.end(), -1);
  stepper_->start();
}

void Block::step(int sample) {
  if (!program_.source.memories.empty()) {
    file_.load_row(schedule_.carry_row(sample), program_.carry.uniforms.kernel.outputs);
    run(*program_.carry.linked, executor_, file_.file);
  }
  stepper_->step(sample);
}

void Block::observe(int sample) {
  for (std::size_t c = 0; c < program_.observe.size(); ++c) {
    if (!schedule_.summed(static_cast<int>(c), sample)) continue;
    file_.load_row(schedule_.observe_row(static_cast<int>(c), sample), program_.observe[c].uniforms.kernel.outputs);
    run(*program_.observe[c].linked, executor_, file_.file);
  }
}

void Block::record(int sample) {
  file_.load_row(schedule_.record_row(sample), program_.record.uniforms.kernel.outputs);
  run(*program_.record.linked, executor_, file_.file);
}

void Block::finish() {
  std::vector<double> const& row = schedule_.epilogue_row();
  file_.load_row(row.data(), static_cast<int>(row.size()));
  run(*program_.epilogue.linked, executor_, file_.file);
}

void Block::load(ConstLanes registers) {
  for (int r = 0; r < registers.rows(); ++r) {
    double* const row = file_.registers + r * executor_.stride();
    for (int w = 0; w < executor_.width; ++w) row[w] = registers(r, std::min(w, lanes_ - 1));
  }
  std::fill(death_.begin(), death_.end(), -1);
}

void Block::store(Lanes registers) const {
  for (int r = 0; r < registers.rows(); ++r)
    std::copy_n(file_.registers + r * executor_.stride(), lanes_, registers.row(r).begin());
}

bool Block::bury(int sample) {
  ConstLanes const now = states();
  int live = -1;
  bool found_dead = false;
  for (int w = 0; w < lanes_; ++w) {
    int& death = death_[static_cast<std::size_t>(w)];
    for (int r = 0; r < now.rows() && death < 0; ++r)
      if (!std::isfinite(now(r, w))) death = sample;
    found_dead = found_dead || death == sample;
    if (death < 0) live = w;
  }
  if (live < 0 || !found_dead) return live >= 0;
  // Infinities and NaNs can be slow in elementary functions: nothing but live values is computed from here on.
  for (int r = 0; r < program_.registers.first_record(); ++r) {
    double* const row = file_.registers + r * executor_.stride();
    for (int w = 0; w < executor_.width; ++w)
      if (w >= lanes_ || death_[static_cast<std::size_t>(w)] >= 0) row[w] = row[live];
  }
  return true;
}

}  // namespace sysid
