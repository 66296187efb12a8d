// One operation of the bytecode as instructions of LLVM, on a vector of lanes or on one double.
#pragma once
#include <llvm/ADT/DenseMap.h>
#include <llvm/IR/IRBuilder.h>

#include "program/bytecode/opcode.hpp"

namespace sysid::native {

/// Writes at the builder's place. Values are those of the scalar executor bit for bit, but for the payload of a NaN.
class Arithmetic {
 public:
  /// type: double, or a vector of it.
  Arithmetic(llvm::IRBuilder<>& builder, llvm::Type* type) : builder_(builder), type_(type) {}

  /// Everything but calls of functions. Operands that the operation does not have are null.
  llvm::Value* compute(Opcode opcode, llvm::Value* a, llvm::Value* b, llvm::Value* c);
  llvm::Value* constant(double value) const;

 private:
  /// A truth value in machine form: neither set means that it does not hold.
  struct Condition {
    llvm::Value* holds = nullptr;
    llvm::Value* unknown = nullptr;  // never together with `holds`
  };
  llvm::Value* fused(Opcode opcode, llvm::Value* a, llvm::Value* b, llvm::Value* c);
  llvm::Value* logical(Opcode opcode, llvm::Value* a, llvm::Value* b);
  llvm::Value* sign(llvm::Value* a);
  llvm::Value* extremum(llvm::Value* a, llvm::Value* b, llvm::Value* a_wins);
  llvm::Value* select(llvm::Value* a, llvm::Value* b, llvm::Value* c);
  Condition condition(llvm::Value* a);
  llvm::Value* fails(Condition const& condition);
  llvm::Value* value(Condition const& condition);
  llvm::Value* unordered(llvm::Value* a, llvm::Value* b);
  llvm::Value* intrinsic(llvm::Intrinsic::ID name, llvm::Value* a);

  llvm::IRBuilder<>& builder_;
  llvm::Type* type_;
  llvm::DenseMap<llvm::Value*, Condition> conditions_;  // of values that comparisons left, so that choices need not compare again
};

}  // namespace sysid::native
