// A block backwards: the states are read from a tape that the way forwards has written.
#include <algorithm>

#include "simulate/block.hpp"

namespace sysid {

std::size_t Block::tape_row() const {
  return static_cast<std::size_t>(schedule_.solver().substeps) * static_cast<std::size_t>(program_.registers.states) *
         static_cast<std::size_t>(executor_.width);
}

void Block::copy_states(double* to) const {
  double const* from = file_.registers + program_.registers.first_state() * executor_.stride();
  for (int s = 0; s < program_.registers.states; ++s, from += executor_.stride(), to += executor_.width)
    std::copy_n(from, executor_.width, to);
}

void Block::put_states(double const* states) {
  double* to = file_.registers + program_.registers.first_state() * executor_.stride();
  for (int s = 0; s < program_.registers.states; ++s, to += executor_.stride(), states += executor_.width)
    std::copy_n(states, executor_.width, to);
}

void Block::advance_to_tape(int from, int to, int step_to, bool look, double* tape) {
  if (observe_loop_ != nullptr)
    return in_parts(from, to, [&](int begin, int end) {
      call(observe_loop_, {.tape = tape + tape_row() * static_cast<std::size_t>(begin - from),
                           .from = begin,
                           .to = end,
                           .look_from = look ? begin : end,
                           .step_to = step_to});
    });
  int const substeps = schedule_.solver().substeps, width = program_.step.uniforms.kernel.outputs;
  std::size_t const row = tape_row() / static_cast<std::size_t>(substeps);
  for (int i = from; i < to; ++i, tape += tape_row()) {
    if (i >= step_to) copy_states(tape);
    if (look) observe(i);
    if (i < step_to) take_length(i);
    for (int substep = 0; substep < substeps && i < step_to; ++substep) {
      copy_states(tape + row * static_cast<std::size_t>(substep));
      file_.load_row(schedule_.step_row(i, substep), width);
      run(*program_.step.linked, executor_, file_.file);
    }
  }
}

void Block::reverse_interpreted(int sample, bool step, double const* tape) {
  ReverseSections const& sections = program_.reverse;
  int const substeps = schedule_.solver().substeps;
  std::size_t const row = tape_row() / static_cast<std::size_t>(substeps);
  if (step) take_length(sample);
  for (int substep = substeps; step && substep-- > 0;) {
    put_states(tape + row * static_cast<std::size_t>(substep));
    file_.load_row(schedule_.reverse_step_row(sample, substep), sections.step.uniforms.kernel.outputs);
    run(*sections.step.linked, executor_, file_.file);
  }
  length_values_.step_reversed();
  put_states(tape);
  for (std::size_t c = 0; c < sections.observe.size(); ++c) {
    if (!schedule_.summed(static_cast<int>(c), sample)) continue;
    file_.load_row(schedule_.reverse_observe_row(static_cast<int>(c), sample), sections.observe[c].uniforms.kernel.outputs);
    run(*sections.observe[c].linked, executor_, file_.file);
  }
}

void Block::reverse(int from, int to, int step_to, double const* tape) {
  StepLengths const& lengths = schedule_.lengths();
  for (int begin = to; reverse_loop_ != nullptr && to > from; to = begin) {
    take_length(to - 1);
    int const length = lengths.of[static_cast<std::size_t>(to - 1)];
    begin = lengths.count() == 1 ? from : to - 1;
    while (begin > from && length_values_.keeps(length) && lengths.of[static_cast<std::size_t>(begin - 1)] == length) --begin;
    call(reverse_loop_, {.tape = const_cast<double*>(tape) + tape_row() * static_cast<std::size_t>(begin - from),
                         .from = begin,
                         .to = to,
                         .look_from = begin,
                         .step_to = step_to});
    length_values_.step_reversed();
  }
  for (int i = to; i-- > from;) reverse_interpreted(i, i < step_to, tape + tape_row() * static_cast<std::size_t>(i - from));
}

void Block::start_reverse() {
  double* const first = file_.registers + program_.registers.first_adjoint() * executor_.stride();
  std::fill(first, first + (program_.registers.adjoints + program_.registers.slopes) * executor_.stride(), 0.0);
  length_values_.start_reverse();
}

void Block::finish_reverse() {
  length_values_.finish_reverse();
  file_.load_row(schedule_.reverse_start_row(), program_.reverse.start.uniforms.kernel.outputs);
  run(*program_.reverse.start.linked, executor_, file_.file);
}

}  // namespace sysid
