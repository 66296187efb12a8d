// Running bytecode: linked for every instruction set and width, and the scalar reference. All executors give the same bytes.
#pragma once
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "core/numeric/instruction_set.hpp"
#include "program/bytecode/code.hpp"
#include "program/interpreter/step.hpp"

namespace sysid {

enum class ExecutorKind {
  automatic,  // native where it pays, else lanes
  scalar,     // the oracle: one lane, one instruction after the other
  lanes,      // bytecode on vectors
  native,     // machine code, made of the bytecode; what is not in a loop is interpreted in lanes
};
std::string_view name(ExecutorKind kind);

/// An executor of `width` lanes at a time, in vectors of one instruction set.
struct Executor {
  InstructionSet set = narrowest_instruction_set;
  int width = 4;
  ExecutorKind kind = ExecutorKind::lanes;

  /// Doubles from one row of a register file to the next. Rows of wide blocks are a cache line apart: at multiples of 4096 bytes a
  /// load would seem to depend on every store a whole number of pages away.
  int stride() const { return width >= 16 ? width + 8 : width; }
};

/// The executors of lanes of a set, narrow to wide.
std::span<Executor const> executors(InstructionSet set);
/// Those of machine code. Four vectors side by side fill the processor; more would not fit its registers.
std::span<Executor const> native_executors(InstructionSet set);
/// The executor of the set in force for a block of `lanes`: the narrowest that holds them, but at most `widest`.
Executor choose_executor(int lanes, int widest = 1 << 30, ExecutorKind kind = ExecutorKind::lanes);
/// An executor for a rest of `lanes` of a batch that `executor` runs: narrower where that costs no compilation.
Executor narrowed(Executor executor, int lanes);

/// Doubles of a register file that `uniforms` uniforms take, so that rows begin on a cache line.
constexpr int uniform_space(int uniforms) { return (uniforms + 7) / 8 * 8; }

/// Code linked for every executor of this processor.
struct LinkedCode {
  Code code;  // as it is, for the oracle
  int uniforms = 0;
  std::vector<Step> narrow[4], wide[4];  // AVX2 (NEON) and AVX-512, in the order of `executors`
  std::vector<Step> const& steps(Executor executor) const;
};

/// uniforms: size of the file's uniform part. Offsets are the same for every section that shares a file.
std::shared_ptr<LinkedCode const> link(Code const& code, int uniforms);

/// file: uniform_space(uniforms) doubles, then rows of executor.width lanes, on a 64-byte boundary.
void run(LinkedCode const& code, Executor executor, double* file);

/// The oracle: one lane, one instruction after the other.
void run_scalar(Code const& code, double const* uniforms, double* registers);

}  // namespace sysid
