// Straight-line code: the vectors side by side, a few instructions of each in turn, so that the latency of one is filled by others.
#include <algorithm>

#include "expression/function.hpp"
#include "native/llvm/loop_writer.hpp"

namespace sysid::native {
namespace {

bool is_call(Instruction const& instruction) {
  return instruction.opcode == Opcode::call_unary || instruction.opcode == Opcode::call_binary;
}

}  // namespace

void LoopWriter::write_section(SectionCode const& section, llvm::Value* row) {
  uniforms_.clear();
  std::size_t const size = section.code.size();
  for (std::size_t i = 0; i < size;) {
    if (is_call(section.code[i])) {
      write_call(section.code[i++], row);
      continue;
    }
    std::size_t end = i;
    while (end < size && end - i < static_cast<std::size_t>(interleaving_.instructions) && !is_call(section.code[end])) ++end;
    for (std::size_t v = 0; v < accumulator_.size(); ++v)
      for (std::size_t k = i; k < end; ++k) write_instruction(section.code[k], row, v);
    i = end;
  }
  if (!writes_out()) forget_temporaries();
}

void LoopWriter::write_instruction(Instruction const& instruction, llvm::Value* row, std::size_t vector) {
  auto const read = [&](Operand const& each) { return operand(each, row, vector); };
  llvm::Value* const result =
      arithmetic_.compute(instruction.opcode, read(instruction.a), read(instruction.b), read(instruction.c));
  if (result == nullptr) known_ = false;
  accumulator_[vector] = result;
  if (!instruction.store) return;
  Row& target = registers_.try_emplace(instruction.target, Row(accumulator_.size())).first->second;
  target[vector] = result;
}

// The functions are those that the interpreters call, or the vector functions behind them.
void LoopWriter::write_call(Instruction const& instruction, llvm::Value* row) {
  if (void const* const form = form_in_registers(instruction))
    write_call_in_registers(instruction, row, form);
  else
    write_call_through_memory(instruction, row);
}

void const* LoopWriter::form_in_registers(Instruction const& instruction) const {
  ::sysid::Function const& function = *instruction.function;
  bool const binary = instruction.opcode == Opcode::call_binary;
  if (loop_.vector_lanes == 1)
    return binary ? reinterpret_cast<void const*>(function.binary) : reinterpret_cast<void const*>(function.unary);
  if (loop_.vector_form == nullptr) return nullptr;
  return loop_.vector_form(
      binary ? reinterpret_cast<void const*>(function.binary_lanes) : reinterpret_cast<void const*>(function.unary_lanes),
      loop_.vector_lanes == 8);
}

void LoopWriter::write_call_in_registers(Instruction const& instruction, llvm::Value* row, void const* function) {
  Row& target = registers_.try_emplace(instruction.target, Row(accumulator_.size())).first->second;
  Row results(accumulator_.size());
  for (std::size_t v = 0; v < results.size(); ++v) {
    std::vector<llvm::Value*> arguments{operand(instruction.a, row, v)};
    if (instruction.opcode == Opcode::call_binary) arguments.push_back(operand(instruction.b, row, v));
    llvm::FunctionType* const type = llvm::FunctionType::get(type_, std::vector<llvm::Type*>(arguments.size(), type_), false);
    llvm::CallInst* const result = builder_.CreateCall(type, address_of(function, type), arguments);
    result->setDoesNotThrow();
    results[v] = result;
  }
  target = accumulator_ = results;
}

void LoopWriter::write_call_through_memory(Instruction const& instruction, llvm::Value* row) {
  bool const binary = instruction.opcode == Opcode::call_binary;
  auto const place_in = [&](int which, std::size_t v) {
    llvm::Value* const at =
        builder_.CreateConstInBoundsGEP1_64(double_, buffer(which), v * static_cast<std::size_t>(loop_.vector_lanes));
    return builder_.CreateBitCast(at, type_->getPointerTo());
  };
  for (int argument = 0; argument < (binary ? 2 : 1); ++argument)
    for (std::size_t v = 0; v < accumulator_.size(); ++v)
      builder_.CreateAlignedStore(operand(argument == 0 ? instruction.a : instruction.b, row, v), place_in(argument, v),
                                  llvm::Align(32));
  std::vector<llvm::Value*> arguments{buffer(0)};
  if (binary) arguments.push_back(buffer(1));
  arguments.push_back(buffer(2));
  arguments.push_back(builder_.getInt32(static_cast<std::uint32_t>(loop_.vector_lanes * loop_.vectors)));
  std::vector<llvm::Type*> types;
  for (llvm::Value* const each : arguments) types.push_back(each->getType());
  auto const function = binary ? reinterpret_cast<void const*>(instruction.function->binary_lanes)
                               : reinterpret_cast<void const*>(instruction.function->unary_lanes);
  llvm::FunctionType* const type = llvm::FunctionType::get(builder_.getVoidTy(), types, false);
  builder_.CreateCall(type, address_of(function, type), arguments)->setDoesNotThrow();
  Row& target = registers_.try_emplace(instruction.target, Row(accumulator_.size())).first->second;
  for (std::size_t v = 0; v < accumulator_.size(); ++v)
    target[v] = accumulator_[v] = builder_.CreateAlignedLoad(type_, place_in(2, v), llvm::Align(32));
}

llvm::Value* LoopWriter::address_of(void const* function, llvm::FunctionType* type) {
  return builder_.CreateIntToPtr(builder_.getInt64(reinterpret_cast<std::uintptr_t>(function)), type->getPointerTo());
}

llvm::Value* LoopWriter::operand(Operand const& operand, llvm::Value* row, std::size_t vector) {
  switch (operand.place) {
    case OperandPlace::lane:
      return row_of(operand.index)[vector];
    case OperandPlace::uniform:
      return uniform(operand.index, row);
    case OperandPlace::accumulator:
      return accumulator_[vector];
    case OperandPlace::none:
      break;
  }
  return nullptr;
}

llvm::Value* LoopWriter::uniform(std::uint32_t index, llvm::Value* row) {
  if (index < loop_.constants.size()) return arithmetic_.constant(loop_.constants[index]);
  llvm::Value*& value = uniforms_[index];
  if (value == nullptr) {
    value = builder_.CreateLoad(double_, builder_.CreateConstInBoundsGEP1_64(double_, row, index - loop_.constants.size()));
    if (loop_.vector_lanes > 1) value = builder_.CreateVectorSplat(static_cast<unsigned>(loop_.vector_lanes), value);
  }
  return value;
}

// A register that has no value yet is one that the loop only reads.
LoopWriter::Row& LoopWriter::row_of(std::uint32_t number) {
  auto const [found, fresh] = registers_.try_emplace(number);
  if (fresh)
    for (std::size_t v = 0; v < accumulator_.size(); ++v) {
      llvm::Value* const at = entry_.CreateBitCast(place(number, v), type_->getPointerTo());
      found->second.push_back(entry_.CreateAlignedLoad(type_, at, llvm::Align(8)));
    }
  return found->second;
}

llvm::Value* LoopWriter::place(std::uint32_t number, std::size_t vector) {
  std::uint64_t const offset = static_cast<std::uint64_t>(number) * static_cast<std::uint64_t>(loop_.stride) +
                               vector * static_cast<std::uint64_t>(loop_.vector_lanes);
  return entry_.CreateConstInBoundsGEP1_64(double_, registers_pointer_, offset);
}

llvm::Value* LoopWriter::row_at(llvm::Value* table, llvm::Value* index, int width) {
  return builder_.CreateInBoundsGEP(double_, table,
                                    {builder_.CreateMul(index, builder_.getInt64(static_cast<std::uint64_t>(width)))});
}

llvm::Value* LoopWriter::buffer(int index) {
  if (buffers_.empty()) {
    auto const size = static_cast<std::uint64_t>(loop_.vector_lanes * loop_.vectors);
    for (int i = 0; i < 3; ++i) {
      llvm::AllocaInst* const memory = entry_.CreateAlloca(double_, entry_.getInt64(size));
      memory->setAlignment(llvm::Align(64));
      buffers_.push_back(memory);
    }
  }
  return buffers_[static_cast<std::size_t>(index)];
}

}  // namespace sysid::native
