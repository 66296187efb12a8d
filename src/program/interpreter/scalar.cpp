// The scalar executor: the meaning of the bytecode, plainly; the lane executors are held to it bit for bit.
#include <cmath>
#include <limits>

#include "core/text/diagnostic.hpp"
#include "program/interpreter/executor.hpp"

namespace sysid {
namespace {

double condition(bool holds) { return holds ? 1.0 : 0.0; }
double compared(double a, double b, bool holds) {
  return a != a || b != b ? std::numeric_limits<double>::quiet_NaN() : condition(holds);
}

double compute(Instruction const& i, double a, double b, double c) {
  switch (i.opcode) {
    case Opcode::move:
      return a;
    case Opcode::negate:
      return -a;
    case Opcode::add:
      return a + b;
    case Opcode::subtract:
      return a - b;
    case Opcode::multiply:
      return a * b;
    case Opcode::divide:
      return a / b;
    case Opcode::fused:
      return std::fma(a, b, c);
    case Opcode::fused_subtract:
      return std::fma(a, b, -c);
    case Opcode::fused_negate:
      return std::fma(-a, b, c);
    case Opcode::fused_both:
      return std::fma(-a, b, -c);
    case Opcode::square_root:
      return std::sqrt(a);
    case Opcode::absolute:
      return std::fabs(a);
    case Opcode::sign:
      return compared(a, 0, a > 0) - condition(a < 0);
    case Opcode::minimum:
      return a != a || a < b ? a : b;
    case Opcode::maximum:
      return a != a || a > b ? a : b;
    case Opcode::floor:
      return std::floor(a);
    case Opcode::less:
      return compared(a, b, a < b);
    case Opcode::less_equal:
      return compared(a, b, a <= b);
    case Opcode::equal:
      return compared(a, b, a == b);
    case Opcode::conjunction:
      return a == 0 || b == 0 ? 0 : compared(a, b, true);
    case Opcode::disjunction:
      return (a == a && a != 0) || (b == b && b != 0) ? 1 : compared(a, b, false);
    case Opcode::negation:
      return compared(a, 0, a == 0);
    case Opcode::select:
      return a != a ? a : a != 0 ? b : c;
    case Opcode::call_unary:
      return i.function->unary(a);
    case Opcode::call_binary:
      return i.function->binary(a, b);
  }
  throw InternalError("an instruction without a meaning");
}

}  // namespace

void run_scalar(Code const& code, double const* uniforms, double* registers) {
  double accumulator = 0;
  auto const read = [&](Operand const& operand) {
    switch (operand.place) {
      case OperandPlace::lane:
        return registers[operand.index];
      case OperandPlace::uniform:
        return uniforms[operand.index];
      case OperandPlace::accumulator:
        return accumulator;
      case OperandPlace::none:
        break;
    }
    return 0.0;
  };
  for (Instruction const& i : code) {
    accumulator = compute(i, read(i.a), read(i.b), read(i.c));
    if (i.store) registers[i.target] = accumulator;
  }
}

}  // namespace sysid
