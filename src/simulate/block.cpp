// The loop body of every simulation: copy a row of uniforms, run the section; or the whole loop as machine code.
#include "simulate/block.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulate/machine_loop.hpp"

namespace sysid {
namespace {

/// A section that reads no data but the length of a step.
void run_of_length(LaneFile const& file, Section const& section, int length) {
  bool const prologue = &section == &file.program.prologue;
  file.load_row(prologue ? file.schedule.prologue_row(length) : file.schedule.reverse_values_row(length),
                section.uniforms.kernel.outputs);
  run(*section.linked, file.executor, file.file);
}

native::Function length_loop_if_compiled(SimulationProgram const& program, Schedule const& schedule, Executor executor) {
  if (schedule.lengths().count() == 1 || executor.kind != ExecutorKind::native) return nullptr;
  return program.machine_code->compiled(length_loop_name());
}

}  // namespace

Block::Block(SimulationProgram const& program, Schedule const& schedule, Executor executor, int lanes, native::LoopKind loop,
             bool (*stopped)())
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
            memory_.view().data() + uniform_space(program.uniforms),
            stopped},
      stepper_(make_stepper(file_)),
      length_values_(program, executor, file_.registers, schedule.lengths().count(),
                     [file = file_](Section const& section, int length) { run_of_length(file, section, length); },
                     {length_loop_if_compiled(program, schedule, executor), lanes_of_length_loop(), schedule.prologue_row(0)}),
      death_(static_cast<std::size_t>(lanes), -1) {
  // Where steps are not fixed, records are interpreted: nearly all the time goes into the steps.
  if (loop == native::LoopKind::observe || loop == native::LoopKind::tape)
    observe_loop_ = machine_loop(program, schedule.solver(), executor, loop);
  else if (fixed_step() && !program.source.corrects())
    record_loop_ = machine_loop(program, schedule.solver(), executor, loop);
  if (loop == native::LoopKind::tape) reverse_loop_ = machine_loop(program, schedule.solver(), executor, native::LoopKind::reverse);
  std::copy(program.constants.begin(), program.constants.end(), file_.file);
}

void Block::set_parameters(ConstLanes parameters) {
  for (int r = 0; r < program_.registers.parameters; ++r) {
    double* const row = file_.registers + r * executor_.stride();
    for (int w = 0; w < executor_.width; ++w) row[w] = parameters(r, std::min(w, lanes_ - 1));
  }
  run_of_length(file_, program_.prologue, 0);
  length_values_.parameters_changed();
  stepper_->parameters_changed();
}

void Block::take_length(int sample) {
  if (schedule_.lengths().count() > 1) length_values_.take(schedule_.lengths().of[static_cast<std::size_t>(sample)]);
}

template <class Action>
void Block::in_parts(int from, int to, Action const& action) {
  if (schedule_.lengths().count() == 1) return action(from, to);
  for (int end = from; from < to; from = end) {
    end = std::min(to, schedule_.lengths().until[static_cast<std::size_t>(from)]);
    take_length(from);
    action(from, end);
  }
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
  take_length(sample);
  if (runs_loops())
    return call(observe_loop_ != nullptr ? observe_loop_ : record_loop_,
                {.from = sample, .to = sample + 1, .look_from = sample + 1, .step_to = sample + 1});
  carry(sample);
  stepper_->step(sample);
}

void Block::step(int sample, int substep) {
  take_length(sample);
  int const width = program_.step.uniforms.kernel.outputs;
  double const* const row = schedule_.step_row(sample, substep);
  // The machine code finds the row of a sample by its number.
  if (runs_loops() && program_.source.memories.empty() && schedule_.solver().substeps > 1)
    return call(observe_loop_ != nullptr ? observe_loop_ : record_loop_,
                {.steps = row - static_cast<std::ptrdiff_t>(sample) * width,
                 .from = sample,
                 .to = sample + 1,
                 .look_from = sample + 1,
                 .step_to = sample + 1,
                 .substeps = 1});
  if (substep == 0) carry(sample);
  file_.load_row(row, width);
  run(*program_.step.linked, executor_, file_.file);
}

void Block::carry(int sample) {
  if (program_.source.memories.empty()) return;
  file_.load_row(schedule_.carry_row(sample), program_.carry.uniforms.kernel.outputs);
  run(*program_.carry.linked, executor_, file_.file);
}

void Block::observe(int sample) {
  for (std::size_t c = 0; c < program_.observe.size(); ++c) {
    if (!schedule_.summed(static_cast<int>(c), sample)) continue;
    file_.load_row(schedule_.observe_row(static_cast<int>(c), sample), program_.observe[c].uniforms.kernel.outputs);
    run(*program_.observe[c].linked, executor_, file_.file);
  }
}

void Block::step_to(int from, int to) {
  if (runs_loops() && !program_.source.corrects())
    return in_parts(from, to, [&](int begin, int end) {
      call(observe_loop_ != nullptr ? observe_loop_ : record_loop_, {.from = begin, .to = end, .look_from = end, .step_to = end});
    });
  for (int i = from; i < to; ++i) {
    pass(i);
    step(i);
  }
}

void Block::pass(int sample) {
  if (program_.source.corrects()) observe(sample);
}

void Block::advance(int from, int to, int step_to) {
  if (observe_loop_ != nullptr && fixed_step())
    return in_parts(from, to, [&](int begin, int end) {
      call(observe_loop_, {.from = begin, .to = end, .look_from = begin, .step_to = step_to});
    });
  for (int i = from; i < to; ++i) {
    if (observe_loop_ != nullptr)
      call(observe_loop_, {.from = i, .to = i + 1, .look_from = i});
    else
      observe(i);
    if (i < step_to) step(i);
  }
}

void Block::call(native::Function function, native::Call call) const {
  std::size_t const channels = program_.observe.size();
  // Few programs have more channels than this; those wait for memory.
  constexpr std::size_t most = 16;
  double const* rows_here[most];
  std::uint8_t const* summed_here[most];
  std::vector<double const*> more_rows(channels > most ? channels : 0);
  std::vector<std::uint8_t const*> more_summed(channels > most ? channels : 0);
  double const** const rows = channels > most ? more_rows.data() : rows_here;
  std::uint8_t const** const summed = channels > most ? more_summed.data() : summed_here;
  bool const backwards = function == reverse_loop_;
  for (std::size_t c = 0; c < channels; ++c) {
    rows[c] = backwards ? schedule_.reverse_observe_row(static_cast<int>(c), 0) : schedule_.observe_row(static_cast<int>(c), 0);
    summed[c] = schedule_.summed(static_cast<int>(c));
  }
  double const* const record = schedule_.record_row(0);
  bool const records = function == record_loop_;
  call.registers = file_.registers;
  call.rows = records ? &record : rows;
  call.summed = summed;
  call.carry = schedule_.carry_row(0);
  if (call.steps == nullptr) {
    call.steps = backwards ? schedule_.reverse_step_row(0, 0) : schedule_.step_row(0, 0);
    call.substeps = schedule_.solver().substeps;
  }
  function(&call);
}

void Block::record(int from, int to, Lanes out) {
  if (record_loop_ == nullptr || !fixed_step()) return record_interpreted(from, to, out);
  int const rows = (to - from) * program_.registers.records;
  if (recorded_.rows() < rows) recorded_ = LaneArray(rows, executor_.width);
  in_parts(from, to, [&](int begin, int end) {
    double* const first = recorded_.row((begin - from) * program_.registers.records).data();
    call(record_loop_, {.out = first, .from = begin, .to = end, .look_from = begin, .step_to = to - 1});
  });
  for (int r = 0; r < rows; ++r) std::copy_n(recorded_.row(r).begin(), lanes_, out.row(r).begin());
}

void Block::record_interpreted(int from, int to, Lanes out) {
  int row = 0;
  for (int i = from; i < to; ++i) {
    file_.load_row(schedule_.record_row(i), program_.record.uniforms.kernel.outputs);
    run(*program_.record.linked, executor_, file_.file);
    if (program_.source.corrects()) correct_recorded(i);
    ConstLanes const now = rows(program_.registers.first_record(), program_.registers.records);
    for (int r = 0; r < now.rows(); ++r) std::copy_n(now.row(r).begin(), lanes_, out.row(row++).begin());
    if (i + 1 < to) step(i);
  }
}

void Block::correct_recorded(int sample) {
  std::vector<int> const& times = program_.source.recorded_at;
  double* row = file_.registers + program_.registers.first_record() * executor_.stride();
  for (std::size_t r = 0; r < times.size(); ++r, row += executor_.stride())
    if (times[r] >= 0 && times[r] < after_channels) std::fill_n(row, executor_.width, std::numeric_limits<double>::quiet_NaN());
  observe(sample);
  file_.load_row(schedule_.record_after_row(sample), program_.record_after.uniforms.kernel.outputs);
  run(*program_.record_after.linked, executor_, file_.file);
}

void Block::finish() { finish(schedule_.epilogue_row()); }

void Block::finish(std::span<double const> counts) {
  file_.load_row(counts.data(), static_cast<int>(counts.size()));
  run(*program_.epilogue.linked, executor_, file_.file);
}

void Block::load(ConstLanes registers) {
  for (int r = 0; r < registers.rows(); ++r) {
    double* const row = file_.registers + r * executor_.stride();
    for (int w = 0; w < executor_.width; ++w) row[w] = registers(r, std::min(w, lanes_ - 1));
  }
  std::fill(death_.begin(), death_.end(), -1);
  length_values_.registers_changed();
}

void Block::store(Lanes registers) const {
  for (int r = 0; r < registers.rows(); ++r)
    std::copy_n(file_.registers + r * executor_.stride(), lanes_, registers.row(r).begin());
}

void Block::enter(int lane, std::span<double const> states) {
  double* row = file_.registers + program_.registers.first_state() * executor_.stride() + lane;
  for (double const state : states) {
    *row = state;
    row += executor_.stride();
  }
  row = file_.registers + program_.registers.first_accumulator() * executor_.stride() + lane;
  for (int r = 0; r < program_.registers.accumulators; ++r, row += executor_.stride()) *row = 0;
}

// Most blocks have nothing to bury, most of the time; this takes a few vector instructions.
bool Block::all_live_and_finite() const {
  ConstLanes const now = states();
  int bad = 0;
  for (int r = 0; r < now.rows(); ++r) {
    double const* const row = now.row(r).data();
    for (int w = 0; w < lanes_; ++w) bad |= std::fabs(row[w]) <= std::numeric_limits<double>::max() ? 0 : 1;
  }
  return bad == 0 && std::all_of(death_.begin(), death_.end(), [](int death) { return death < 0; });
}

bool Block::bury(int sample) {
  if (all_live_and_finite()) return true;
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
  length_values_.registers_changed();
  return true;
}

}  // namespace sysid
