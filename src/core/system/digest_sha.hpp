// Blocks of SHA-256 by the processor's own instructions: what digest_sha.cpp offers to digest.cpp.
#pragma once
#include <cstddef>
#include <cstdint>

namespace sysid {

/// state: a to h; constants: the 64 of the rounds; blocks: of 64 bytes. Where the processor has SHA instructions alone.
void add_blocks_by_instructions(std::uint32_t* state, std::uint32_t const* constants, unsigned char const* data,
                                std::size_t blocks);

}  // namespace sysid
