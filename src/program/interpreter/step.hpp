// Linked bytecode: one instruction as the lane executors run it, a handler and byte offsets. No std templates: see CMakeLists.txt.
#pragma once
#include <cstdint>

#include "program/bytecode/opcode.hpp"

namespace sysid {

using Handler = void (*)();  // its true type is known to the executor of one instruction set and width

/// Offsets count from the beginning of a register file: uniforms first (8 bytes each), then rows of lanes.
struct Step {
  Handler handler;
  std::uint32_t target;
  std::uint32_t a;
  union {
    std::uint32_t bc[2];                                         // the further operands
    void (*unary)(double const*, double*, int);                  // call_unary
    void (*binary)(double const*, double const*, double*, int);  // in the slot after a call_binary
  };
};

/// What the handlers of an instruction are chosen by.
struct InstructionShape {
  Opcode opcode;
  bool store;
  OperandPlace a, b, c;
};

namespace avx2 {                                     // widths 4, 8, 16, 32
Handler handler(InstructionShape shape, int width);  // nullptr: there is none
Handler end(int width);                              // what the last step of every code does: return
void run(Step const* steps, char* file, int width);
}  // namespace avx2
namespace avx512 {  // widths 8, 16, 32, 64
Handler handler(InstructionShape shape, int width);
Handler end(int width);
void run(Step const* steps, char* file, int width);
}  // namespace avx512

}  // namespace sysid
