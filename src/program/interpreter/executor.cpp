// Links bytecode to the handlers of every executor this processor can run.
#include "program/interpreter/executor.hpp"

#include <fmt/format.h>

#include "core/text/diagnostic.hpp"

namespace sysid {
namespace {

constexpr InstructionSet narrow = narrowest_instruction_set;

// NEON has no block of 32 lanes: its sixteen vectors would not fit the registers that pass arguments.
#if defined(__aarch64__)
constexpr Executor narrow_executors[] = {{narrow, 4}, {narrow, 8}, {narrow, 16}};
#else
constexpr Executor narrow_executors[] = {{narrow, 4}, {narrow, 8}, {narrow, 16}, {narrow, 32}};
#endif
// Four lanes fill one narrow vector: the wide set gains nothing from them and has no handlers for it.
constexpr Executor wide_executors[] = {{narrow, 4},
                                       {InstructionSet::avx512, 8},
                                       {InstructionSet::avx512, 16},
                                       {InstructionSet::avx512, 32},
                                       {InstructionSet::avx512, 64}};

constexpr Executor narrow_native[] = {{narrow, 1, ExecutorKind::native},
                                      {narrow, 4, ExecutorKind::native},
                                      {narrow, 8, ExecutorKind::native},
                                      {narrow, 16, ExecutorKind::native}};
constexpr Executor wide_native[] = {{narrow, 1, ExecutorKind::native},
                                    {narrow, 4, ExecutorKind::native},
                                    {InstructionSet::avx512, 8, ExecutorKind::native},
                                    {InstructionSet::avx512, 16, ExecutorKind::native},
                                    {InstructionSet::avx512, 32, ExecutorKind::native}};

std::vector<Step> link_for(Code const& code, int uniforms, Executor executor) {
  bool const wide = executor.set == InstructionSet::avx512;
  std::uint32_t const rows = static_cast<std::uint32_t>(uniform_space(uniforms)) * 8;
  std::uint32_t const row = static_cast<std::uint32_t>(executor.stride()) * 8;
  auto const offset = [&](Operand const& operand) {
    return operand.place == OperandPlace::uniform ? operand.index * 8 : rows + operand.index * row;
  };
  std::vector<Step> steps;
  steps.reserve(code.size() + 1);
  for (Instruction const& i : code) {
    InstructionShape const shape{i.opcode, i.store, i.a.place, i.b.place, i.c.place};
    Handler const handler = wide ? wide_set::handler(shape, executor.width) : narrow_set::handler(shape, executor.width);
    if (handler == nullptr) throw InternalError(fmt::format("no executor has the instruction `{}`", capability(i.opcode).name));
    Step step{handler, rows + i.target * row, offset(i.a), {{offset(i.b), offset(i.c)}}};
    if (i.opcode == Opcode::call_unary) step.unary = i.function->unary_lanes;
    steps.push_back(step);
    if (i.opcode == Opcode::call_binary) {
      Step data{};
      data.binary = i.function->binary_lanes;
      steps.push_back(data);
    }
  }
  Step last{};
  last.handler = wide ? wide_set::end(executor.width) : narrow_set::end(executor.width);
  steps.push_back(last);
  return steps;
}

int position(Executor executor) {
  int index = 0;
  for (int width = executor.set == InstructionSet::avx512 ? 8 : 4; width < executor.width; width *= 2) ++index;
  return index;
}

}  // namespace

std::span<Executor const> executors(InstructionSet set) {
  if (set == InstructionSet::avx512) return wide_executors;
  return narrow_executors;
}

std::span<Executor const> native_executors(InstructionSet set) {
  if (set == InstructionSet::avx512) return wide_native;
  return narrow_native;
}

std::string_view name(ExecutorKind kind) {
  switch (kind) {
    case ExecutorKind::scalar:
      return "scalar";
    case ExecutorKind::lanes:
      return "lanes";
    case ExecutorKind::native:
      return "native";
    case ExecutorKind::automatic:
      break;
  }
  return "auto";
}

Executor choose_executor(int lanes, int widest, ExecutorKind kind) {
  if (kind == ExecutorKind::scalar) return {narrow, 1, kind};
  std::span<Executor const> const all =
      kind == ExecutorKind::native ? native_executors(instruction_set()) : executors(instruction_set());
  Executor chosen = all.front();
  for (Executor const& executor : all) {
    if (executor.width > widest) break;
    chosen = executor;
    if (executor.width >= lanes) break;
  }
  return chosen;
}

Executor narrowed(Executor executor, int lanes) {
  return executor.kind == ExecutorKind::lanes ? choose_executor(lanes, executor.width) : executor;
}

std::vector<Step> const& LinkedCode::steps(Executor executor) const {
  int const index = position(executor);
  return executor.set == InstructionSet::avx512 ? wide[index] : narrow[index];
}

std::shared_ptr<LinkedCode const> link(Code const& code, int uniforms) {
  auto linked = std::make_shared<LinkedCode>();
  linked->code = code;
  linked->uniforms = uniforms;
  for (Executor const& executor : narrow_executors) linked->narrow[position(executor)] = link_for(code, uniforms, executor);
  if (supported_instruction_set() == InstructionSet::avx512)
    for (Executor const& executor : wide_executors)
      if (executor.set == InstructionSet::avx512) linked->wide[position(executor)] = link_for(code, uniforms, executor);
  return linked;
}

void run(LinkedCode const& code, Executor executor, double* file) {
  if (executor.width == 1) return run_scalar(code.code, file, file + uniform_space(code.uniforms));
  Step const* steps = code.steps(executor).data();
  if (executor.set == InstructionSet::avx512)
    wide_set::run(steps, reinterpret_cast<char*>(file), executor.width);
  else
    narrow_set::run(steps, reinterpret_cast<char*>(file), executor.width);
}

}  // namespace sysid
