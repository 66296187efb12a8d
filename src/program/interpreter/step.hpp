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

/// Of each instruction set: `handler` is null where there is none; `end` is what the last step of every code does, return.
#if defined(__aarch64__)
namespace neon {  // widths 4, 8, 16
Handler handler(InstructionShape shape, int width);
Handler end(int width);
void run(Step const* steps, char* file, int width);
}  // namespace neon
namespace narrow_set = neon;
namespace wide_set = neon;
#else
namespace avx2 {  // widths 4, 8, 16, 32
Handler handler(InstructionShape shape, int width);
Handler end(int width);
void run(Step const* steps, char* file, int width);
}  // namespace avx2
namespace avx512 {  // widths 8, 16, 32, 64
Handler handler(InstructionShape shape, int width);
Handler end(int width);
void run(Step const* steps, char* file, int width);
}  // namespace avx512
namespace narrow_set = avx2;
namespace wide_set = avx512;
#endif

}  // namespace sysid
