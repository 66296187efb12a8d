// The bytecode every executor runs: a straight line of instructions over registers of lanes, uniforms and one accumulator.
// It is what the program stage emits and `--dump program` shows; executors link it to their own handlers and hold it no other way.
#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

#include "expression/function.hpp"
#include "program/bytecode/opcode.hpp"

namespace sysid {

struct Operand {
  OperandPlace place = OperandPlace::none;
  std::uint32_t index = 0;  // of the register or uniform
  friend bool operator==(Operand, Operand) = default;
};

struct Instruction {
  Opcode opcode = Opcode::move;
  bool store = true;  // the result goes to register `target`, not to the accumulator alone
  std::uint32_t target = 0;
  Operand a{}, b{}, c{};
  Function const* function = nullptr;
};

using Code = std::vector<Instruction>;

/// What an executor can do in one instruction; the emitter brings everything else into such a form with moves.
struct Capability {
  std::string_view name;
  int operands;
  bool accumulator;  // operands may be read from the accumulator, and the result may stay there
  bool commutative;  // operands a, b may be exchanged: they stand in the order accumulator, lane, uniform
};
Capability const& capability(Opcode opcode);

}  // namespace sysid
