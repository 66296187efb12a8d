// Names of the bytecode's operations and operand places, alone: files compiled for one instruction set may include this and nothing
// more.
#pragma once
#include <cstdint>

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
enum class OperandPlace : std::uint8_t { none, lane, uniform, accumulator };

}  // namespace sysid
