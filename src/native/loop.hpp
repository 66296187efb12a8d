// What machine code is made of and how it is called: a loop over samples as sections of bytecode. The program and the module that
// compiles share this header and nothing else, so the module needs nothing of the program, and the program nothing of LLVM.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "program/bytecode/code.hpp"

namespace sysid::native {

/// Straight-line code over registers, and the number of uniforms that one row of its table has.
struct SectionCode {
  std::span<Instruction const> code;
  int row = 0;
};

enum class LoopKind {
  observe,  // at each sample: the sections whose channel is summed there; then the steps to the next sample
  record,   // at each sample: one section, whose results are written out; then the steps to the next sample
  attempt,  // the step section again and again, until no lane's position is below 1
  tape,     // as `observe`, and the states at each sample and before each step are written out
  reverse,  // the samples backwards: the states are read from where `tape` wrote them; back over the steps from a sample, then the
            // sections whose channel is summed there
  values,   // for each length of a step: one section, whose results are written out; it reads parameters alone
};

/// One loop in full. Registers below `kept` hold their values from sample to sample; what is written above them is temporary.
struct Loop {
  LoopKind kind = LoopKind::observe;
  bool wide = false;                  // AVX-512, whose registers 256-bit vectors use too; else AVX2
  int vector_lanes = 4;               // 1: plain doubles
  int vectors = 1;                    // side by side
  int stride = 4;                     // doubles from one register to the next
  bool one_step = true;               // from sample to sample; else `Call::substeps` of them
  std::span<double const> constants;  // the uniforms before a section's row
  std::vector<SectionCode> samples;   // per channel; of a record, of values: one
  SectionCode carry, step;            // an empty step: the states are moved by somebody else
  int kept = 0;
  /// The form in vectors, of 8 lanes if `wide`, else 4, of a function over lanes: called with vectors in registers. Null: none, or
  /// the function has no such form; then it is called through memory.
  void const* (*vector_form)(void const* lanes, bool wide) = nullptr;
  std::vector<std::uint32_t> outputs;  // registers that a record, and values, write out
  int first_state = 0, states = 0;     // registers of the tape
  int position = 0;                    // of an attempt: the register of the lanes' places in the interval
};

/// Arguments of the machine code. Tables are those of the schedule, from its first row on.
struct Call {
  double* registers = nullptr;
  double const* const* rows = nullptr;          // per channel: a row for each sample
  std::uint8_t const* const* summed = nullptr;  // per channel: a flag for each sample
  double const* carry = nullptr;                // a row for each sample
  double const* steps = nullptr;                // `substeps` rows for each sample; of an attempt: the row
  double* out = nullptr;                        // outputs x lanes for each sample from `from` on
  double* tape = nullptr;                       // states x lanes for each step of each sample from `from` on
  std::int64_t from = 0, to = 0;                // samples [from, to)
  std::int64_t look_from = 0;                   // the first that is observed or recorded
  std::int64_t step_to = 0;                     // the first that is not stepped from
  std::int64_t substeps = 1;
  std::int64_t attempts = 0;  // at most so many
};

using Function = void (*)(Call const*);

/// Machine code; owns the memory that it stands in.
class Machine {
 public:
  virtual ~Machine() = default;
  virtual Function function() const = 0;
};

/// The compiled loop; null with the reason in `why` where this cannot be.
using Compile = std::unique_ptr<Machine> (*)(Loop const& loop, std::string& why);

/// The symbol of the module: its version is that of the program that it was built with.
struct Module {
  char const* version;
  Compile compile;
};
using ModuleEntry = Module const* (*)();
inline constexpr char const* module_entry = "sysid_native_module";

}  // namespace sysid::native
