// Which sections a loop has, and what it costs to compile and to interpret it.
#include "simulate/machine_loop.hpp"

#include <algorithm>

#include "core/numeric/elementary.hpp"
#include "core/numeric/instruction_set.hpp"
#include "program/embedded.hpp"

namespace sysid {
namespace {

native::SectionCode code_of(Section const& section) { return {section.code, section.uniforms.kernel.outputs}; }

/// Instructions of a loop's body beyond which vectors side by side cost more, in spilt registers and in compilation, than the
/// latencies that they hide.
constexpr double largest_body = 500;

constexpr double seconds_by_instruction = 75e-6;  // of one vector, compiled

/// Of a loop over samples, for one vector.
double body(std::size_t steps, std::vector<Section> const& observations) {
  std::size_t sum = steps;
  for (Section const& observe : observations) sum += observe.code.size();
  return static_cast<double>(sum);
}

double forwards(SimulationProgram const& program) {
  return body(program.step.code.size() + program.carry.code.size(), program.observe);
}

double backwards(SimulationProgram const& program) { return body(program.reverse.step.code.size(), program.reverse.observe); }

/// Whether machine code may use AVX-512: blocks of four lanes too, as it has twice as many registers for their vectors of 256 bits.
bool uses_avx512() { return instruction_set() == InstructionSet::avx512; }

int vector_lanes(Executor executor) { return executor.width == 1 ? 1 : vector_lanes(executor.set); }
int vectors(Executor executor) { return executor.width / vector_lanes(executor); }

native::Loop write_loop(SimulationProgram const& program, SolverSettings const& solver, Executor executor, native::LoopKind kind) {
  native::Loop loop;
  loop.kind = kind;
  loop.wide = uses_avx512();
  loop.vector_lanes = vector_lanes(executor);
  loop.vectors = vectors(executor);
  loop.vector_form = &elementary::vector_form;
  loop.stride = executor.stride();
  loop.one_step = solver.substeps == 1;
  loop.constants = program.constants;
  loop.kept = program.registers.carried();
  loop.first_state = program.registers.first_state();
  loop.states = program.registers.states;
  if (kind == native::LoopKind::reverse) {
    for (Section const& observe : program.reverse.observe) loop.samples.push_back(code_of(observe));
    loop.step = code_of(program.reverse.step);
    return loop;
  }
  if (kind == native::LoopKind::observe || kind == native::LoopKind::tape)
    for (Section const& observe : program.observe) loop.samples.push_back(code_of(observe));
  if (kind == native::LoopKind::record) loop.samples.push_back(code_of(program.record));
  if (solver.fixed_step() && kind != native::LoopKind::attempt) loop.carry = code_of(program.carry);
  if (solver.fixed_step() || kind == native::LoopKind::attempt) loop.step = code_of(program.step);
  for (int r = 0; r < program.registers.records; ++r)
    loop.outputs.push_back(static_cast<std::uint32_t>(program.registers.first_record() + r));
  loop.position = program.registers.first_control() + static_cast<int>(Control::position);
  return loop;
}

native::Loop write_length_loop(SimulationProgram const& program) {
  native::Loop loop;
  loop.kind = native::LoopKind::values;
  loop.wide = uses_avx512();
  loop.stride = loop.vector_lanes = lanes_of_length_loop();
  loop.vector_form = &elementary::vector_form;
  loop.constants = program.constants;
  loop.samples.push_back(code_of(program.prologue));
  for (int const each : program.length_values) loop.outputs.push_back(static_cast<std::uint32_t>(each));
  return loop;
}

}  // namespace

int lanes_of_length_loop() { return vector_lanes(instruction_set()); }

native::LoopName length_loop_name() { return {native::LoopKind::values, uses_avx512(), lanes_of_length_loop(), true}; }

native::Function length_loop(SimulationProgram const& program) {
  return program.machine_code->function(length_loop_name(), [&] { return write_length_loop(program); });
}

double length_compilation_time(SimulationProgram const& program) {
  return seconds_by_instruction * static_cast<double>(program.prologue.code.size());
}

native::LoopName machine_loop_name(SolverSettings const& solver, Executor executor, native::LoopKind kind) {
  return {kind, uses_avx512(), executor.width, solver.substeps == 1};
}

native::Function machine_loop(SimulationProgram const& program, SolverSettings const& solver, Executor executor,
                              native::LoopKind kind) {
  if (executor.kind != ExecutorKind::native) return nullptr;
  return program.machine_code->function(machine_loop_name(solver, executor, kind),
                                        [&] { return write_loop(program, solver, executor, kind); });
}

double compilation_time(SimulationProgram const& program, Executor executor) {
  return seconds_by_instruction * (forwards(program) + backwards(program)) * vectors(executor);
}

int most_native_lanes(SimulationProgram const& program) {
  int most = 1;
  double const instructions = std::max(forwards(program), backwards(program));
  for (Executor const& each : native_executors(instruction_set()))
    if (vectors(each) == 1 || instructions * vectors(each) <= largest_body) most = std::max(most, each.width);
  return most;
}

double speed(Executor executor) { return executor.kind == ExecutorKind::native ? 4 : 1; }

double interpretation_time(double instructions, int lanes, Executor executor) {
  double const blocks = (lanes + executor.width - 1) / executor.width;
  return instructions * blocks * (0.5e-9 + 0.04e-9 * executor.width);
}

}  // namespace sysid
