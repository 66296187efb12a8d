// The frame of the loop: what stays in registers, where control goes, and which section comes when.
#include "native/llvm/loop_writer.hpp"

#include <cstddef>
#include <set>

namespace sysid::native {

LoopWriter::LoopWriter(llvm::Module& module, Loop const& loop, Interleaving interleaving)
    : module_(module),
      context_(module.getContext()),
      loop_(loop),
      interleaving_(interleaving),
      builder_(context_),
      entry_(context_),
      double_(builder_.getDoubleTy()),
      type_(loop.vector_lanes == 1 ? double_ : llvm::FixedVectorType::get(double_, static_cast<unsigned>(loop.vector_lanes))),
      pointer_(double_->getPointerTo()),
      integer_(builder_.getInt64Ty()),
      arithmetic_(builder_, type_),
      accumulator_(static_cast<std::size_t>(loop.vectors)) {}

bool LoopWriter::write(char const* name) {
  llvm::FunctionType* const type = llvm::FunctionType::get(builder_.getVoidTy(), {builder_.getInt8PtrTy()}, false);
  function_ = llvm::Function::Create(type, llvm::Function::ExternalLinkage, name, module_);
  function_->addFnAttr(llvm::Attribute::NoUnwind);
  char const* const bits =
      loop_.vector_lanes == 8 ? "512" : "256";  // else a vector may be split in two where the processor is not known
  function_->addFnAttr("min-legal-vector-width", bits);
  function_->addFnAttr("prefer-vector-width", bits);
  call_ = function_->getArg(0);
  llvm::BasicBlock* const entry = block("entry");
  // All that is read before the loop stands before the jump into it.
  builder_.SetInsertPoint(entry);
  llvm::BasicBlock* const first = block("first");
  entry_.SetInsertPoint(builder_.CreateBr(first));
  registers_pointer_ = argument(offsetof(Call, registers), pointer_);
  builder_.SetInsertPoint(first);
  find_kept();
  load_kept();
  if (loop_.kind == LoopKind::attempt)
    write_attempts();
  else if (loop_.kind == LoopKind::reverse)
    write_reverse();
  else
    write_samples();
  return known_;
}

llvm::BasicBlock* LoopWriter::block(char const* name) { return llvm::BasicBlock::Create(context_, name, function_); }

llvm::Value* LoopWriter::argument(std::size_t offset, llvm::Type* type) {
  llvm::Value* const place = entry_.CreateConstInBoundsGEP1_64(entry_.getInt8Ty(), call_, offset);
  return entry_.CreateLoad(type, entry_.CreateBitCast(place, type->getPointerTo()));
}

// --- the loop over samples ---

void LoopWriter::write_samples() {
  llvm::Value* const from = argument(offsetof(Call, from), integer_);
  llvm::Value* const to = argument(offsetof(Call, to), integer_);
  llvm::Value* const look_from = argument(offsetof(Call, look_from), integer_);
  llvm::BasicBlock *const before = builder_.GetInsertBlock(), *const loop = block("sample"), *const finish = block("finish");
  builder_.CreateCondBr(builder_.CreateICmpSLT(from, to), loop, finish);
  Registers const untouched = kept_values();

  builder_.SetInsertPoint(loop);
  llvm::PHINode* const sample = builder_.CreatePHI(integer_, 2);
  sample->addIncoming(from, before);
  Registers const open = open_loop(before);
  if (loop_.kind == LoopKind::tape) write_tape(first_step(sample));

  llvm::BasicBlock *const look = block("look"), *const looked = block("looked");
  llvm::BasicBlock* const head = builder_.GetInsertBlock();
  Registers const at_head = kept_values();
  builder_.CreateCondBr(builder_.CreateICmpSGE(sample, look_from), look, looked);
  builder_.SetInsertPoint(look);
  write_look(sample);
  builder_.CreateBr(looked);
  join(looked, head, at_head);

  if (!loop_.step.code.empty() || !loop_.carry.code.empty()) write_steps(sample);

  llvm::Value* const next = builder_.CreateAdd(sample, builder_.getInt64(1));
  sample->addIncoming(next, builder_.GetInsertBlock());
  close_loop(open);
  builder_.CreateCondBr(builder_.CreateICmpSLT(next, to), loop, finish);
  join(finish, before, untouched);
  store_kept();
  builder_.CreateRetVoid();
}

void LoopWriter::write_look(llvm::Value* sample) {
  if (writes_out()) return write_record(sample);
  for (std::size_t channel = 0; channel < loop_.samples.size(); ++channel)
    if (!loop_.samples[channel].code.empty()) write_channel(channel, sample);
}

void LoopWriter::write_channel(std::size_t channel, llvm::Value* sample) {
  llvm::Type *const byte = builder_.getInt8Ty(), *const bytes = byte->getPointerTo();
  auto const of_channel = [&](std::size_t offset, llvm::Type* type) {
    llvm::Value* const all = argument(offset, type->getPointerTo());
    return entry_.CreateLoad(type, entry_.CreateConstInBoundsGEP1_64(type, all, channel));
  };
  llvm::Value* const rows = of_channel(offsetof(Call, rows), pointer_);
  llvm::Value* const summed = of_channel(offsetof(Call, summed), bytes);
  llvm::BasicBlock *const before = builder_.GetInsertBlock(), *const observe = block("observe"), *const done = block("observed");
  llvm::Value* const flag = builder_.CreateLoad(byte, builder_.CreateInBoundsGEP(byte, summed, {sample}));
  builder_.CreateCondBr(builder_.CreateICmpNE(flag, builder_.getInt8(0)), observe, done);
  Registers const unobserved = kept_values();
  builder_.SetInsertPoint(observe);
  SectionCode const& section = loop_.samples[channel];
  write_section(section, row_at(rows, sample, section.row));
  builder_.CreateBr(done);
  join(done, before, unobserved);
}

void LoopWriter::write_record(llvm::Value* sample) {
  llvm::Value* const out = argument(offsetof(Call, out), pointer_);
  llvm::Value* const from = argument(offsetof(Call, from), integer_);
  llvm::Value* const rows = entry_.CreateLoad(pointer_, argument(offsetof(Call, rows), pointer_->getPointerTo()));
  SectionCode const& section = loop_.samples.front();
  write_section(section, row_at(rows, sample, section.row));
  int const width = loop_.vector_lanes * loop_.vectors;
  llvm::Value* const place = row_at(out, builder_.CreateSub(sample, from), static_cast<int>(loop_.outputs.size()) * width);
  for (std::size_t r = 0; r < loop_.outputs.size(); ++r) {
    Row const& values = row_of(loop_.outputs[r]);
    for (int v = 0; v < loop_.vectors; ++v) {
      auto const lane = r * static_cast<std::size_t>(width) + static_cast<std::size_t>(v * loop_.vector_lanes);
      llvm::Value* const at = builder_.CreateConstInBoundsGEP1_64(double_, place, lane);
      builder_.CreateAlignedStore(values[static_cast<std::size_t>(v)], builder_.CreateBitCast(at, type_->getPointerTo()),
                                  llvm::Align(8));
    }
  }
  forget_temporaries();
}

void LoopWriter::write_steps(llvm::Value* sample) {
  llvm::Value* const step_to = argument(offsetof(Call, step_to), integer_);
  llvm::BasicBlock *const before = builder_.GetInsertBlock(), *const steps = block("steps"), *const stepped = block("stepped");
  builder_.CreateCondBr(builder_.CreateICmpSLT(sample, step_to), steps, stepped);
  Registers const unstepped = kept_values();
  builder_.SetInsertPoint(steps);
  if (!loop_.carry.code.empty())
    write_section(loop_.carry, row_at(argument(offsetof(Call, carry), pointer_), sample, loop_.carry.row));
  forget_temporaries();
  if (loop_.one_step)
    write_section(loop_.step, row_at(argument(offsetof(Call, steps), pointer_), sample, loop_.step.row));
  else
    write_substeps(sample);
  builder_.CreateBr(stepped);
  join(stepped, before, unstepped);
}

llvm::Value* LoopWriter::first_step(llvm::Value* sample) {
  return loop_.one_step ? sample : builder_.CreateMul(sample, argument(offsetof(Call, substeps), integer_));
}

void LoopWriter::write_substeps(llvm::Value* sample) {
  llvm::Value* const substeps = argument(offsetof(Call, substeps), integer_);
  llvm::Value* const first = first_step(sample);
  llvm::BasicBlock *const before = builder_.GetInsertBlock(), *const loop = block("substep"), *const done = block("substeps_done");
  builder_.CreateBr(loop);  // there is one at least
  builder_.SetInsertPoint(loop);
  llvm::PHINode* const substep = builder_.CreatePHI(integer_, 2);
  substep->addIncoming(builder_.getInt64(0), before);
  Registers const open = open_loop(before);
  llvm::Value* const row = builder_.CreateAdd(first, substep);
  if (loop_.kind == LoopKind::tape) write_tape(row);
  write_section(loop_.step, row_at(argument(offsetof(Call, steps), pointer_), row, loop_.step.row));
  llvm::Value* const next = builder_.CreateAdd(substep, builder_.getInt64(1));
  substep->addIncoming(next, builder_.GetInsertBlock());
  close_loop(open);
  builder_.CreateCondBr(builder_.CreateICmpSLT(next, substeps), loop, done);
  builder_.SetInsertPoint(done);
}

// --- attempts at a step ---

void LoopWriter::write_attempts() {
  llvm::Value* const attempts = argument(offsetof(Call, attempts), integer_);
  llvm::Value* const row = argument(offsetof(Call, steps), pointer_);
  llvm::BasicBlock *const before = builder_.GetInsertBlock(), *const loop = block("attempt"), *const finish = block("finish");
  llvm::Value* const some = builder_.CreateICmpSGT(attempts, builder_.getInt64(0));
  builder_.CreateCondBr(builder_.CreateAnd(some, somebody_travels()), loop, finish);
  Registers const untouched = kept_values();
  builder_.SetInsertPoint(loop);
  llvm::PHINode* const attempt = builder_.CreatePHI(integer_, 2);
  attempt->addIncoming(builder_.getInt64(0), before);
  Registers const open = open_loop(before);
  write_section(loop_.step, row);
  llvm::Value* const next = builder_.CreateAdd(attempt, builder_.getInt64(1));
  attempt->addIncoming(next, builder_.GetInsertBlock());
  close_loop(open);
  llvm::Value* const more = builder_.CreateICmpSLT(next, attempts);
  builder_.CreateCondBr(builder_.CreateAnd(more, somebody_travels()), loop, finish);
  join(finish, before, untouched);
  store_kept();
  builder_.CreateRetVoid();
}

llvm::Value* LoopWriter::somebody_travels() {
  llvm::Value* any = nullptr;
  for (llvm::Value* const position : Row(row_of(static_cast<std::uint32_t>(loop_.position)))) {
    llvm::Value* const below = builder_.CreateFCmpOLT(position, arithmetic_.constant(1));
    any = any == nullptr ? below : builder_.CreateOr(any, below);
  }
  return loop_.vector_lanes == 1 ? any : builder_.CreateOrReduce(any);
}

// --- what outlives a sample ---

void LoopWriter::find_kept() {
  std::set<std::uint32_t> written;
  auto const add = [&](SectionCode const& section) {
    for (Instruction const& instruction : section.code)
      if (instruction.store && instruction.target < static_cast<std::uint32_t>(loop_.kept)) written.insert(instruction.target);
  };
  for (SectionCode const& section : loop_.samples) add(section);
  add(loop_.carry);
  add(loop_.step);
  kept_.assign(written.begin(), written.end());
}

void LoopWriter::load_kept() {
  for (std::uint32_t const number : kept_) row_of(number);
}

void LoopWriter::store_kept() {
  for (std::uint32_t const number : kept_)
    for (std::size_t v = 0; v < accumulator_.size(); ++v) {
      llvm::Value* const at = builder_.CreateBitCast(place(number, v), type_->getPointerTo());
      builder_.CreateAlignedStore(row_of(number)[v], at, llvm::Align(8));
    }
}

LoopWriter::Registers LoopWriter::kept_values() {
  Registers values;
  for (std::uint32_t const number : kept_) values[number] = row_of(number);
  return values;
}

LoopWriter::Registers LoopWriter::open_loop(llvm::BasicBlock* from) {
  Registers open;
  for (std::uint32_t const number : kept_) {
    Row& row = row_of(number);
    for (llvm::Value*& value : row) {
      llvm::PHINode* const phi = builder_.CreatePHI(type_, 2);
      phi->addIncoming(value, from);
      value = phi;
    }
    open[number] = row;
  }
  return open;
}

void LoopWriter::close_loop(Registers const& open) {
  for (auto const& [number, phis] : open)
    for (std::size_t v = 0; v < phis.size(); ++v)
      llvm::cast<llvm::PHINode>(phis[v])->addIncoming(row_of(number)[v], builder_.GetInsertBlock());
}

void LoopWriter::join(llvm::BasicBlock* block, llvm::BasicBlock* from, Registers const& other) {
  llvm::BasicBlock* const here = builder_.GetInsertBlock();
  builder_.SetInsertPoint(block);
  for (auto const& [number, values] : other) {
    Row& row = row_of(number);
    for (std::size_t v = 0; v < values.size(); ++v) {
      if (row[v] == values[v]) continue;
      llvm::PHINode* const phi = builder_.CreatePHI(type_, 2);
      phi->addIncoming(row[v], here);
      phi->addIncoming(values[v], from);
      row[v] = phi;
    }
  }
}

void LoopWriter::forget_temporaries() {
  std::erase_if(registers_, [&](auto const& row) { return row.first >= static_cast<std::uint32_t>(loop_.kept); });
}

}  // namespace sysid::native
