// Stored files with changed bytes: each is refused or means what it meant, and none ends the program. For tests/fuzz/stored.cpp,
// which makes hundreds of thousands, and the test of some thousands in tests/report/stored_files.cpp.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace sysid::fuzz {

/// A file of a stored result, and what reading it gives.
struct StoredFile {
  std::string name;   // summary.json, draws_1.csv, predict.csv, report.cbor
  std::string bytes;  // as written
};

/// A result, written into `folder`.
std::vector<StoredFile> write_example(std::filesystem::path const& folder);

/// Those of a folder that a run has left.
std::vector<StoredFile> stored_files(std::filesystem::path const& folder);

struct Outcome {
  std::uint64_t refused = 0, same = 0;
  std::string fault;  // what was read in place of what was written, and from which bytes; empty: nothing
};

/// Changes `file` in `folder` `count` times, by the numbers of `seed`, reads it each time as the program does, as a report and, if
/// given, by `later`, which gives what it reads as text; and puts it back.
/// Then also what stands behind checksums is changed and sealed again: of that anything may be read, but the reader must come back.
Outcome mutate(std::filesystem::path const& folder, StoredFile const& file, std::uint64_t count, std::uint64_t seed,
               std::function<std::string()> const& later = {});

}  // namespace sysid::fuzz
