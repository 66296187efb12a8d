// Checkpoints with changed bytes, read and resumed by the program's own code: each is refused or goes on to the result that was on
// its way. For tests/fuzz/stored.cpp, which makes hundreds of thousands, and for the test in
// tests/app/session/changed_checkpoints.cpp.
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
  std::string holds;       // where in what is stored the part lies that is asked about: "/journal"
};
std::vector<CheckpointCase> checkpoint_cases();

struct CheckpointOutcome : Outcome {
  std::uint64_t forged_refused = 0, forged_taken = 0;
  std::uint64_t whole = 0;  // runs from beginning to end
};

/// Changes the checkpoint of such a run `count` times, by the numbers of `seed`. What the program's reader refuses, every run that
/// goes on refuses before anything else; every `every`-th is resumed all the same, and each that the reader takes is resumed to the
/// end and compared. Then what the seal vouches for is changed and sealed again: of that anything may come, but the program must
/// come back, without a fault of its own. It is read by the task's own run, up to where that computes something new; every
/// `every`-th goes on from there.
CheckpointOutcome mutate_checkpoint(std::filesystem::path const& folder, CheckpointCase const& what, std::uint64_t count,
                                    std::uint64_t seed, std::uint64_t every);

}  // namespace sysid::fuzz
