// Asks the processor once which vector instructions it has; a test or the user may force the narrower set.
#include "core/numeric/instruction_set.hpp"

#include <atomic>

#include "core/text/diagnostic.hpp"

namespace sysid {
namespace {

InstructionSet best_or_refuse() {
  if (std::optional<InstructionSet> const best = supported_instruction_set()) return *best;
  throw UserError({.code = "E0001",
                   .message = "this processor lacks AVX2 and FMA (x86-64-v3), which sysid needs",
                   .primary = {},
                   .secondary = {},
                   .help = "use a processor with AVX2 and FMA, or enable them in the virtual machine"});
}

std::atomic<int>& forced() {
  static std::atomic<int> set = static_cast<int>(best_or_refuse());
  return set;
}

}  // namespace

std::optional<InstructionSet> supported_instruction_set() {
#if defined(__aarch64__)
  return InstructionSet::neon;
#else
  __builtin_cpu_init();
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return std::nullopt;
  bool const wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
  return wide ? InstructionSet::avx512 : InstructionSet::avx2;
#endif
}

InstructionSet instruction_set() { return static_cast<InstructionSet>(forced().load(std::memory_order_relaxed)); }

void force_instruction_set(InstructionSet set) {
  if (set > best_or_refuse()) {
    throw UserError({.code = "E0002",
                     .message = "this processor has no AVX-512 instructions",
                     .primary = {},
                     .secondary = {},
                     .help = "remove the option, or choose avx2: the results are identical"});
  }
  forced().store(static_cast<int>(set), std::memory_order_relaxed);
}

std::string_view name(InstructionSet set) {
  switch (set) {
    case InstructionSet::neon:
      return "neon";
    case InstructionSet::avx2:
      return "avx2";
    case InstructionSet::avx512:
      break;
  }
  return "avx512";
}

}  // namespace sysid
