// The bytecode every executor runs: a straight line of instructions over registers of lanes, uniforms and one accumulator.
// It is what the program stage emits and `--dump program` shows; executors link it to their own handlers and hold it no other way.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "expression/function.hpp"

namespace sysid {

enum class Opcode : std::uint8_t {
  move,            // a
  negate,          // -a
  add,             // a + b
  subtract,        // a - b
  multiply,        // a * b
  divide,          // a / b
  fused,           // a*b + c, rounded once, as are the next three
  fused_subtract,  // a*b - c
  fused_negate,    // -(a*b) + c
  fused_both,      // -(a*b) - c
  square_root,
  absolute,
  sign,
  minimum,
  maximum,
  floor,
  less,
  less_equal,
  equal,
  conjunction,
  disjunction,
  negation,
  select,       // a ? b : c
  call_unary,   // function(a)
  call_binary,  // function(a, b)
};

/// Where an operand is read. A register has one value per lane, a uniform one value for all lanes; the accumulator is the result of
/// the instruction before, which executors keep in machine registers.
struct Operand {
  enum class Place : std::uint8_t { none, lane, uniform, accumulator };
  Place place = Place::none;
  std::uint32_t index = 0;  // register or uniform
};

struct Instruction {
  Opcode opcode = Opcode::move;
  bool store = true;  // the result goes to register `target`, not to the accumulator alone
  std::uint32_t target = 0;
  Operand a, b, c;
  Function const* function = nullptr;
};

using Code = std::vector<Instruction>;

/// The number of operands an operation reads, 1 to 3.
int operand_count(Opcode opcode);
std::string name(Opcode opcode);

}  // namespace sysid
