// Files read whole and written whole: a reader never sees half a file, a failed write leaves the old one and names the reason.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "core/text/diagnostic.hpp"

namespace sysid {

/// From here on what writes, makes, renames and removes files does nothing: another process of the same run does it.
void leave_files_to_another();
bool files_are_left();

/// Paths of the files beside `path`, spelt as it is, in order: for "did you mean".
std::vector<std::string> files_beside(std::filesystem::path const& path);

/// The bytes of a file; of one that holds `most` or more (a device may have no end), at least the first `most`. IoError
/// "cannot read `PATH`: reason" otherwise.
std::string read_file(std::filesystem::path const& path, std::size_t most = std::numeric_limits<std::size_t>::max());

/// The bytes of a regular file. A device or pipe, which may have no end or never begin, is refused with IoError, as what cannot be
/// read is.
std::string read_regular_file(std::filesystem::path const& path, std::size_t most = std::numeric_limits<std::size_t>::max());

/// The size of a regular file; IoError as above.
std::uintmax_t regular_file_size(std::filesystem::path const& path);

/// PATH.partial: what `write_file` calls a file that it has begun. One that stays is of a process that was killed.
std::filesystem::path partial_path(std::filesystem::path path);

/// Writes `bytes` under a temporary name in the same folder (`partial_path`), flushes them to the disk and renames: `path` holds
/// either the old bytes or all of the new. On failure the temporary file is removed and IoError "cannot write `PATH`: reason" is
/// thrown. A symbolic link is followed to what is there, permissions are kept; a device or pipe is written directly.
void write_file(std::filesystem::path const& path, std::string_view bytes);

/// The first half of `write_file`: the bytes stand under `partial_path(path)`, flushed, and what is at `path` stays as it is until
/// `rename_staged`. IoError as there.
void stage_file(std::filesystem::path const& path, std::string_view bytes);

/// The second half: what `stage_file` wrote takes the place of what is at `path`, a symbolic link included. Nothing where it has
/// been done. To be made durable by `flush_folder`.
void rename_staged(std::filesystem::path const& path);

/// IoError where a folder has the name of a file that is to be written.
void require_no_folder(std::filesystem::path const& path);

/// IoError where the permissions are not such that the file could be removed.
void require_removable(std::filesystem::path const& path);

/// Makes renames and removals in a folder durable. Some file systems cannot; the files are whole in any case.
void flush_folder(std::filesystem::path const& folder);

/// The folder with all above it; nothing when it is there. IoError otherwise.
void make_folder(std::filesystem::path const& path);

/// What the file system has refused to a call of the library, such as a name that is too long, in our words.
IoError path_error(std::filesystem::filesystem_error const& error);

/// Of a folder of results that is not there, or is a file: a near name, else how there come to be results.
IoError no_results_folder(std::filesystem::path const& path);

/// Removes a file if it is there. IoError when it is there and cannot be removed.
void remove_file(std::filesystem::path const& path);

}  // namespace sysid
