// Checkpoints with changed bytes, resumed by the program's own code: each is refused or goes on to the result that was on its way.
// For tests/fuzz/stored.cpp, which makes hundreds of thousands, and for the test in tests/app/session/changed_checkpoints.cpp.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "fuzz/stored.hpp"

namespace sysid::fuzz {

/// A small task that stores what is asked about: a search, chains of each sampler, particles, functions.
struct CheckpointCase {
  std::string name, verb;  // "nuts", "fit"
  std::string statement;   // after `task = `
};
std::vector<CheckpointCase> checkpoint_cases();

/// Changes the checkpoint of such a run `count` times, by the numbers of `seed`, and resumes it each time in `folder`. Then also
/// what the seal vouches for is changed and sealed again: of that anything may come, but the program must come back, without a
/// fault of its own.
Outcome mutate_checkpoint(std::filesystem::path const& folder, CheckpointCase const& what, std::uint64_t count, std::uint64_t seed);

}  // namespace sysid::fuzz
