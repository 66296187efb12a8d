// The meaning of each operation as in program/interpreter/scalar.cpp, without a branch.
#include "native/llvm/arithmetic.hpp"

#include <limits>

namespace sysid::native {

llvm::Value* Arithmetic::constant(double value) const { return llvm::ConstantFP::get(type_, value); }

llvm::Value* Arithmetic::intrinsic(llvm::Intrinsic::ID name, llvm::Value* a) { return builder_.CreateUnaryIntrinsic(name, a); }

llvm::Value* Arithmetic::unordered(llvm::Value* a, llvm::Value* b) { return builder_.CreateFCmpUNO(a, b); }

llvm::Value* Arithmetic::compute(Opcode opcode, llvm::Value* a, llvm::Value* b, llvm::Value* c) {
  switch (opcode) {
    case Opcode::move:
      return a;
    case Opcode::negate:
      return builder_.CreateFNeg(a);
    case Opcode::add:
      return builder_.CreateFAdd(a, b);
    case Opcode::subtract:
      return builder_.CreateFSub(a, b);
    case Opcode::multiply:
      return builder_.CreateFMul(a, b);
    case Opcode::divide:
      return builder_.CreateFDiv(a, b);
    case Opcode::fused:
    case Opcode::fused_subtract:
    case Opcode::fused_negate:
    case Opcode::fused_both:
      return fused(opcode, a, b, c);
    case Opcode::square_root:
      return intrinsic(llvm::Intrinsic::sqrt, a);
    case Opcode::absolute:
      return intrinsic(llvm::Intrinsic::fabs, a);
    case Opcode::floor:
      return intrinsic(llvm::Intrinsic::floor, a);
    case Opcode::sign:
      return sign(a);
    case Opcode::minimum:
      return extremum(a, b, builder_.CreateFCmpOLT(a, b));
    case Opcode::maximum:
      return extremum(a, b, builder_.CreateFCmpOGT(a, b));
    case Opcode::select:
      return select(a, b, c);
    default:
      return logical(opcode, a, b);
  }
}

llvm::Value* Arithmetic::fused(Opcode opcode, llvm::Value* a, llvm::Value* b, llvm::Value* c) {
  bool const minus_product = opcode == Opcode::fused_negate || opcode == Opcode::fused_both;
  bool const minus_sum = opcode == Opcode::fused_subtract || opcode == Opcode::fused_both;
  return builder_.CreateIntrinsic(llvm::Intrinsic::fma, {type_},
                                  {minus_product ? builder_.CreateFNeg(a) : a, b, minus_sum ? builder_.CreateFNeg(c) : c});
}

llvm::Value* Arithmetic::sign(llvm::Value* a) {
  llvm::Value* const zero = constant(0);
  llvm::Value* const positive = builder_.CreateSelect(builder_.CreateFCmpOGT(a, zero), constant(1), zero);
  llvm::Value* const known = builder_.CreateSelect(builder_.CreateFCmpOLT(a, zero), constant(-1), positive);
  return builder_.CreateSelect(unordered(a, a), a, known);
}

// A NaN in `a` is the answer; one in `b` is, too, as no comparison with it lets `a` win.
llvm::Value* Arithmetic::extremum(llvm::Value* a, llvm::Value* b, llvm::Value* a_wins) {
  return builder_.CreateSelect(unordered(a, a), a, builder_.CreateSelect(a_wins, a, b));
}

llvm::Value* Arithmetic::select(llvm::Value* a, llvm::Value* b, llvm::Value* c) {
  Condition const chosen = condition(a);
  return builder_.CreateSelect(chosen.unknown, a, builder_.CreateSelect(chosen.holds, b, c));
}

Arithmetic::Condition Arithmetic::condition(llvm::Value* a) {
  auto const known = conditions_.find(a);
  if (known != conditions_.end()) return known->second;
  return {builder_.CreateFCmpONE(a, constant(0)), unordered(a, a)};
}

llvm::Value* Arithmetic::fails(Condition const& condition) {
  return builder_.CreateNot(builder_.CreateOr(condition.holds, condition.unknown));
}

llvm::Value* Arithmetic::value(Condition const& condition) {
  llvm::Value* const known = builder_.CreateSelect(condition.holds, constant(1), constant(0));
  llvm::Value* const result = builder_.CreateSelect(condition.unknown, constant(std::numeric_limits<double>::quiet_NaN()), known);
  conditions_[result] = condition;
  return result;
}

llvm::Value* Arithmetic::logical(Opcode opcode, llvm::Value* a, llvm::Value* b) {
  switch (opcode) {
    case Opcode::less:
      return value({builder_.CreateFCmpOLT(a, b), unordered(a, b)});
    case Opcode::less_equal:
      return value({builder_.CreateFCmpOLE(a, b), unordered(a, b)});
    case Opcode::equal:
      return value({builder_.CreateFCmpOEQ(a, b), unordered(a, b)});
    case Opcode::conjunction: {
      Condition const left = condition(a), right = condition(b);
      llvm::Value* const holds = builder_.CreateAnd(left.holds, right.holds);
      llvm::Value* const known = builder_.CreateOr(builder_.CreateOr(fails(left), fails(right)), holds);
      return value({holds, builder_.CreateNot(known)});
    }
    case Opcode::disjunction: {
      Condition const left = condition(a), right = condition(b);
      llvm::Value* const holds = builder_.CreateOr(left.holds, right.holds);
      llvm::Value* const unknown = builder_.CreateOr(left.unknown, right.unknown);
      return value({holds, builder_.CreateAnd(unknown, builder_.CreateNot(holds))});
    }
    case Opcode::negation: {
      Condition const of = condition(a);
      return value({fails(of), of.unknown});
    }
    default:
      return nullptr;
  }
}

}  // namespace sysid::native
