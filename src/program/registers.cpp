// Banks become consecutive registers, and those that each step touches are counted.
#include "program/registers.hpp"

#include <set>
#include <vector>

#include "program/interpreter/executor.hpp"

namespace sysid {
namespace {

constexpr std::uint32_t bank_of(std::uint32_t index) { return index & 0xff000000u; }
constexpr std::uint32_t position_of(std::uint32_t index) { return index & 0x00ffffffu; }

int first_of(std::uint32_t bank, SimulationProgram const& program) {
  RegisterLayout const& layout = program.registers;
  switch (bank) {
    case hoisted_bank:
      return layout.first_hoisted();
    case state_bank:
      return layout.first_state();
    case control_bank:
      return layout.first_control();
    case accumulator_bank:
      return layout.first_accumulator();
    case adjoint_bank:
      return layout.first_adjoint();
    case slope_bank:
      return layout.first_slope();
    case record_bank:
      return layout.first_record();
    case sum_bank:
      return layout.first_sum();
    case temporary_bank:
      return layout.first_temporary();
    case row_bank:
      return static_cast<int>(program.constants.size());
    default:
      return 0;  // parameters among registers, constants among uniforms
  }
}

std::uint32_t numbered(std::uint32_t index, SimulationProgram const& program) {
  return static_cast<std::uint32_t>(first_of(bank_of(index), program)) + position_of(index);
}

void touch(Code const& code, std::set<std::uint32_t>& registers) {
  for (Instruction const& instruction : code) {
    if (instruction.store) registers.insert(instruction.target);
    for (Operand const& operand : {instruction.a, instruction.b, instruction.c})
      if (operand.place == OperandPlace::lane) registers.insert(operand.index);
  }
}

}  // namespace

void number_registers(SimulationProgram& program, int widest_row) {
  program.uniforms = static_cast<int>(program.constants.size()) + widest_row;
  std::vector<Section*> sections{&program.prologue,      &program.start,         &program.carry,    &program.step,
                                 &program.record,        &program.record_after,  &program.epilogue, &program.reverse.step,
                                 &program.reverse.start, &program.reverse.values};
  for (auto* const observations : {&program.observe, &program.reverse.observe})
    for (Section& observe : *observations) sections.push_back(&observe);
  for (Section* section : sections) {
    for (Instruction& instruction : section->code) {
      if (instruction.store) instruction.target = numbered(instruction.target, program);
      for (Operand* operand : {&instruction.a, &instruction.b, &instruction.c})
        if (operand->place == OperandPlace::lane || operand->place == OperandPlace::uniform)
          operand->index = numbered(operand->index, program);
    }
    section->linked = link(section->code, program.uniforms);
  }
  std::set<std::uint32_t> hot;
  touch(program.step.code, hot);
  touch(program.reverse.step.code, hot);
  int const first = program.registers.first_hoisted();
  for (std::uint32_t const each : hot)
    if (auto const r = static_cast<int>(each); r >= first && r < first + program.registers.hoisted)
      program.length_values.push_back(r);
  for (auto const* const observations : {&program.observe, &program.reverse.observe})
    for (Section const& observe : *observations) touch(observe.code, hot);
  program.hot_registers = static_cast<int>(hot.size());
}

}  // namespace sysid
