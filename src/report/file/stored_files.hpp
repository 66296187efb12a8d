// What is read back of a result: its summary.json, and that all files which the summary names are as they were written.
#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "core/text/diagnostic.hpp"

namespace sysid {

/// Of the files of a result: raised when a reader of before would take them for something else. In each CSV file as "# format = 2".
constexpr int stored_form = 2;

/// Stored results that cannot be used (E6209): damaged, incomplete or of another version.
UserError unusable_result(std::string message);

/// To be called where an exception is handled: one from content of other members, types or lengths than are written becomes the
/// UserError (E6209) that `path` is damaged; others pass on.
[[noreturn]] void throw_damaged(std::filesystem::path const& path);

/// What `read` makes of the content of a stored file. Its seal only says that the bytes are those that were written: by whom, it
/// does not.
template <class Read>
auto interpreted(std::filesystem::path const& path, Read const& read) {
  try {
    return read();
  } catch (...) {
    throw_damaged(path);
  }
}

/// SHA-256 of the files that are read back, by name.
using FileDigests = std::map<std::string, std::string>;

/// Whether a file of that name is read back by its columns: draws, particles, bands, functions.
bool is_stored_table(std::string const& name);

/// A summary with `versions.summary_sha256` set to the digest of the text in which zeros stand there.
std::string sealed_summary(std::string text);
/// These zeros.
std::string unsealed();

/// The text of a result's summary.json. IoError where there is none; UserError (E6209) where it is no summary, of another version
/// or was changed.
std::string read_summary(std::filesystem::path const& folder);

/// The same, and all files that it names are there as they were written, and no others of their kind: else UserError (E6209).
std::string read_whole_summary(std::filesystem::path const& folder);

}  // namespace sysid
