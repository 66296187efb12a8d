// A loop over samples as a function of LLVM's intermediate representation.
#pragma once
#include <llvm/IR/IRBuilder.h>
#include <llvm/IR/Module.h>

#include <map>
#include <vector>

#include "native/llvm/arithmetic.hpp"
#include "native/loop.hpp"

namespace sysid::native {

/// Instructions of one vector before those of the next one: as many as keep the processor busy without running out of registers.
struct Interleaving {
  int instructions = 12;
};

/// Adds the function `name` to the module. What goes from sample to sample is in registers of the machine as far as there are any;
/// parameters and what hangs on them are read before the loop. False: the loop has an instruction that is not known.
class LoopWriter {
 public:
  LoopWriter(llvm::Module& module, Loop const& loop, Interleaving interleaving);
  bool write(char const* name);

 private:
  using Row = std::vector<llvm::Value*>;           // a register: one value per vector
  using Registers = std::map<std::uint32_t, Row>;  // those that have a value, by number

  void write_samples();
  void write_reverse();
  void write_steps_back(llvm::Value* sample);
  void write_tape(llvm::Value* step);
  void read_tape(llvm::Value* step);
  llvm::Value* tape_at(llvm::Value* step);
  llvm::Value* first_step(llvm::Value* sample);
  void write_attempts();
  void write_look(llvm::Value* sample);
  void write_channel(std::size_t channel, llvm::Value* sample);
  void write_record(llvm::Value* sample);
  bool writes_out() const { return loop_.kind == LoopKind::record || loop_.kind == LoopKind::values; }
  void write_steps(llvm::Value* sample);
  void write_substeps(llvm::Value* sample);
  void write_section(SectionCode const& section, llvm::Value* row);
  void write_instruction(Instruction const& instruction, llvm::Value* row, std::size_t vector);
  void write_call(Instruction const& instruction, llvm::Value* row);
  void write_call_through_memory(Instruction const& instruction, llvm::Value* row);
  void write_call_in_registers(Instruction const& instruction, llvm::Value* row, void const* function);
  void const* form_in_registers(Instruction const& instruction) const;

  llvm::Value* operand(Operand const& operand, llvm::Value* row, std::size_t vector);
  llvm::Value* uniform(std::uint32_t index, llvm::Value* row);
  Row& row_of(std::uint32_t number);
  llvm::Value* place(std::uint32_t number, std::size_t vector);
  llvm::Value* argument(std::size_t offset, llvm::Type* type);
  llvm::Value* row_at(llvm::Value* table, llvm::Value* index, int width);
  llvm::Value* buffer(int index);
  llvm::Value* address_of(void const* function, llvm::FunctionType* type);
  llvm::Value* somebody_travels();

  void find_kept();
  void load_kept();
  void store_kept();
  /// A loop begins at the builder's block: kept registers come from where `from` leaves them, or from the loop's end.
  Registers open_loop(llvm::BasicBlock* from);
  void close_loop(Registers const& open);
  /// Goes on in `block`, which is reached from the builder's block and, with the values `other`, from `from`.
  void join(llvm::BasicBlock* block, llvm::BasicBlock* from, Registers const& other);
  Registers kept_values();
  llvm::BasicBlock* block(char const* name);
  void forget_temporaries();

  llvm::Module& module_;
  llvm::LLVMContext& context_;
  Loop const& loop_;
  Interleaving interleaving_;
  llvm::IRBuilder<> builder_;  // where the loop is being written
  llvm::IRBuilder<> entry_;    // before it
  llvm::Type *double_, *type_, *pointer_, *integer_;
  Arithmetic arithmetic_;
  llvm::Function* function_ = nullptr;
  llvm::Value* call_ = nullptr;
  llvm::Value* registers_pointer_ = nullptr;
  std::vector<std::uint32_t> kept_;  // registers that the loop changes and that outlive a sample
  Registers registers_;              // as they are at the builder's place
  Row accumulator_;
  std::map<std::uint32_t, llvm::Value*> uniforms_;  // of the section at hand
  std::vector<llvm::Value*> buffers_;               // arguments and results of functions
  bool known_ = true;
};

}  // namespace sysid::native
