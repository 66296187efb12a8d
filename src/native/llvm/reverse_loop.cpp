// The tape of states, and the loop that reads it backwards.
#include <cstddef>

#include "native/llvm/loop_writer.hpp"

namespace sysid::native {

/// Where the states before a step stand; steps are counted from the first sample of the record.
llvm::Value* LoopWriter::tape_at(llvm::Value* step) {
  llvm::Value* const first = first_step(argument(offsetof(Call, from), integer_));
  return row_at(argument(offsetof(Call, tape), pointer_), builder_.CreateSub(step, first),
                loop_.states * loop_.vector_lanes * loop_.vectors);
}

void LoopWriter::write_tape(llvm::Value* step) {
  llvm::Value* const place = tape_at(step);
  for (int s = 0; s < loop_.states; ++s) {
    Row const& values = row_of(static_cast<std::uint32_t>(loop_.first_state + s));
    for (int v = 0; v < loop_.vectors; ++v) {
      auto const lane = static_cast<std::uint64_t>((s * loop_.vectors + v) * loop_.vector_lanes);
      llvm::Value* const at = builder_.CreateConstInBoundsGEP1_64(double_, place, lane);
      builder_.CreateAlignedStore(values[static_cast<std::size_t>(v)], builder_.CreateBitCast(at, type_->getPointerTo()),
                                  llvm::Align(8));
    }
  }
}

void LoopWriter::read_tape(llvm::Value* step) {
  llvm::Value* const place = tape_at(step);
  for (int s = 0; s < loop_.states; ++s) {
    Row values;
    for (int v = 0; v < loop_.vectors; ++v) {
      auto const lane = static_cast<std::uint64_t>((s * loop_.vectors + v) * loop_.vector_lanes);
      llvm::Value* const at = builder_.CreateConstInBoundsGEP1_64(double_, place, lane);
      values.push_back(builder_.CreateAlignedLoad(type_, builder_.CreateBitCast(at, type_->getPointerTo()), llvm::Align(8)));
    }
    registers_[static_cast<std::uint32_t>(loop_.first_state + s)] = values;
  }
}

void LoopWriter::write_reverse() {
  llvm::Value* const from = argument(offsetof(Call, from), integer_);
  llvm::Value* const to = argument(offsetof(Call, to), integer_);
  llvm::Value* const step_to = argument(offsetof(Call, step_to), integer_);
  llvm::BasicBlock *const before = builder_.GetInsertBlock(), *const loop = block("sample"), *const finish = block("finish");
  builder_.CreateCondBr(builder_.CreateICmpSLT(from, to), loop, finish);
  Registers const untouched = kept_values();

  builder_.SetInsertPoint(loop);
  llvm::PHINode* const after = builder_.CreatePHI(integer_, 2);  // the sample before this one is looked at
  after->addIncoming(to, before);
  Registers const open = open_loop(before);
  llvm::Value* const sample = builder_.CreateSub(after, builder_.getInt64(1));

  llvm::BasicBlock *const steps = block("steps_back"), *const stepped = block("stepped_back");
  llvm::BasicBlock* const head = builder_.GetInsertBlock();
  Registers const at_head = kept_values();
  builder_.CreateCondBr(builder_.CreateICmpSLT(sample, step_to), steps, stepped);
  builder_.SetInsertPoint(steps);
  write_steps_back(sample);
  builder_.CreateBr(stepped);
  join(stepped, head, at_head);
  read_tape(first_step(sample));
  for (std::size_t channel = 0; channel < loop_.samples.size(); ++channel)
    if (!loop_.samples[channel].code.empty()) write_channel(channel, sample);

  after->addIncoming(sample, builder_.GetInsertBlock());
  close_loop(open);
  builder_.CreateCondBr(builder_.CreateICmpSGT(sample, from), loop, finish);
  join(finish, before, untouched);
  store_kept();
  builder_.CreateRetVoid();
}

void LoopWriter::write_steps_back(llvm::Value* sample) {
  llvm::Value* const rows = argument(offsetof(Call, steps), pointer_);
  if (loop_.one_step) {
    read_tape(sample);
    return write_section(loop_.step, row_at(rows, sample, loop_.step.row));
  }
  llvm::Value* const first = first_step(sample);
  llvm::Value* const end = builder_.CreateAdd(first, argument(offsetof(Call, substeps), integer_));
  llvm::BasicBlock *const before = builder_.GetInsertBlock(), *const loop = block("substep_back"), *const done = block("back");
  builder_.CreateBr(loop);  // there is one at least
  builder_.SetInsertPoint(loop);
  llvm::PHINode* const after = builder_.CreatePHI(integer_, 2);
  after->addIncoming(end, before);
  Registers const open = open_loop(before);
  llvm::Value* const step = builder_.CreateSub(after, builder_.getInt64(1));
  read_tape(step);
  write_section(loop_.step, row_at(rows, step, loop_.step.row));
  after->addIncoming(step, builder_.GetInsertBlock());
  close_loop(open);
  builder_.CreateCondBr(builder_.CreateICmpSGT(step, first), loop, done);
  builder_.SetInsertPoint(done);
}

}  // namespace sysid::native
