// States of a few particles at a time go into the block's registers and come back.
#include "simulate/particle_lanes.hpp"

#include <algorithm>

namespace sysid {
namespace {

Executor executor_of(Simulator const& simulator, int count) {
  double const work = work_per_sample(simulator.program(), simulator.schedule());
  return simulator.executor(count, work * simulator.schedule().last_summed() * count, native::LoopKind::record);
}

int whole_blocks(int count, int width) { return (count + width - 1) / width * width; }

}  // namespace

void Block::take_states(ConstLanes states) {
  double* row = file_.registers + program_.registers.first_state() * executor_.stride();
  for (int s = 0; s < states.rows(); ++s, row += executor_.stride()) {
    std::copy_n(states.row(s).begin(), lanes_, row);
    std::fill(row + lanes_, row + executor_.width, states(s, lanes_ - 1));
  }
  if (!fixed_step()) stepper_->start();
}

ParticleLanes::ParticleLanes(Simulator const& simulator, int count)
    : simulator_(simulator),
      count_(count),
      executor_(executor_of(simulator, count)),
      width_(std::min(count, executor_.width)),
      block_(simulator.program(), simulator.schedule(), executor_, width_, native::LoopKind::record, simulator.options().stopped),
      states_(simulator.program().registers.states, whole_blocks(count, width_)),
      records_(simulator.program().registers.records, states_.width()),
      chosen_(static_cast<std::size_t>(count)) {}

void ParticleLanes::take_back(int first) {
  ConstLanes const now = block_.states();
  for (int s = 0; s < now.rows(); ++s) std::copy_n(now.row(s).begin(), width_, states_.row(s).begin() + first);
}

void ParticleLanes::start(ConstLanes shared, ConstLanes own) {
  LaneArray parameters(simulator_.program().registers.parameters, width_);
  for (int p = 0; p < shared.rows(); ++p) std::fill(parameters.row(p).begin(), parameters.row(p).end(), shared(p, 0));
  for (int first = 0; first < count_; first += width_) {
    int const here = std::min(width_, count_ - first);
    for (int p = 0; p < own.rows(); ++p) std::copy_n(own.row(p).begin() + first, here, parameters.row(shared.rows() + p).begin());
    block_.set_parameters(parameters);
    block_.start();
    take_back(first);
  }
}

template <class Step>
void ParticleLanes::move(Step const& step) {
  for (int first = 0; first < count_; first += width_) {
    block_.take_states(of_block(states_, first));
    step();
    take_back(first);
  }
}

void ParticleLanes::step(int sample) {
  move([&] { block_.step(sample); });
}

void ParticleLanes::step(int sample, int substep) {
  move([&] { block_.step(sample, substep); });
}

ConstLanes ParticleLanes::record(int sample) {
  for (int first = 0; first < count_; first += width_) {
    block_.take_states(of_block(states_, first));
    block_.record(sample, sample + 1, of_block(records_, first));
  }
  return records_.view().columns(0, count_);
}

void ParticleLanes::select(std::span<int const> from, int first, int end) {
  for (int s = first; s < end; ++s) {
    double* const row = states_.row(s).data();
    for (std::size_t w = 0; w < from.size(); ++w) chosen_[w] = row[from[w]];
    std::copy(chosen_.begin(), chosen_.end(), row);
  }
}

}  // namespace sysid
