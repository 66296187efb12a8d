// Which vector instructions the hot loops use: found at start, or forced; every choice gives the same bytes.
#pragma once
#include <optional>
#include <string_view>

namespace sysid {

enum class InstructionSet { avx2, avx512 };

/// The best set of this processor; nothing when it lacks even x86-64-v3 (AVX2 and FMA), which sysid needs.
std::optional<InstructionSet> supported_instruction_set();

/// The set in force: supported, unless forced. Forcing one that the processor lacks throws UserError.
InstructionSet instruction_set();
void force_instruction_set(InstructionSet set);
std::string_view name(InstructionSet set);

}  // namespace sysid
