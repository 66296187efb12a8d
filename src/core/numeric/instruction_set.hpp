// Which vector instructions the hot loops use: found at start, or forced; every choice gives the same bytes.
#pragma once
#include <optional>
#include <string_view>

namespace sysid {

enum class InstructionSet { neon, avx2, avx512 };

/// The one that every processor of this build has: AVX2 on x86-64, NEON on AArch64.
#if defined(__aarch64__)
inline constexpr InstructionSet narrowest_instruction_set = InstructionSet::neon;
#else
inline constexpr InstructionSet narrowest_instruction_set = InstructionSet::avx2;
#endif

/// Doubles in one vector.
constexpr int vector_lanes(InstructionSet set) { return set == InstructionSet::avx512 ? 8 : set == InstructionSet::avx2 ? 4 : 2; }

/// The best set of this processor; nothing when it is an x86-64 that lacks AVX2 and FMA (x86-64-v3), which sysid needs.
std::optional<InstructionSet> supported_instruction_set();

/// The set in force: supported, unless forced. Forcing one that the processor lacks throws UserError.
InstructionSet instruction_set();
void force_instruction_set(InstructionSet set);
std::string_view name(InstructionSet set);

}  // namespace sysid
