// Claiming result folders.
#include "app/session/results.hpp"

#include <fmt/format.h>

#include "core/system/files.hpp"
#include "report/file/replacement.hpp"
#include "report/file/standing_files.hpp"

namespace sysid {

std::filesystem::path checkpoint_path(std::filesystem::path const& folder) { return folder / "checkpoint.cbor"; }

bool complete(std::filesystem::path const& folder) {
  return summary_stands(folder) && !std::filesystem::exists(checkpoint_path(folder));
}

ClaimedFolder::MadeFolders::MadeFolders(std::filesystem::path const& folder) {
  if (files_are_left()) return;
  for (auto each = std::filesystem::absolute(folder).lexically_normal(); !std::filesystem::exists(each); each = each.parent_path())
    if (each.has_filename()) paths.push_back(each);
  try {
    make_folder(folder);
  } catch (...) {
    remove_empty();  // a part of the path may be there
    throw;
  }
}

ClaimedFolder::MadeFolders::~MadeFolders() { remove_empty(); }

void ClaimedFolder::MadeFolders::remove_empty() const {
  std::error_code ignored;  // of a folder with something in it, which stays
  for (auto const& each : paths) std::filesystem::remove(each, ignored);
}

std::vector<std::string> ClaimedFolder::MadeFolders::with_lock(std::filesystem::path const& folder) const {
  std::vector<std::string> all;
  if (!files_are_left()) all.push_back((folder / "lock").string());
  for (auto const& each : paths) all.push_back(each.string());
  return all;
}

ClaimedFolder::ClaimedFolder(std::filesystem::path const& folder, RunOptions const& options)
    : made_(folder), lock_(folder), removed_(made_.with_lock(folder)) {
  if (files_are_left()) return;
  complete_replacement(folder);
  if (!options.resume && !options.force) {
    if (std::filesystem::exists(checkpoint_path(folder)))
      throw UserError(result_error("", fmt::format("`{}` contains an interrupted run", folder.string()), resume_or_replace()));
    require_no_result(folder);
  }
  remove_partial(folder);
  // A byte, since a full disk takes empty files.
  write_file(folder / "claim", ".");
  remove_file(folder / "claim");
}

void remove_earlier(std::filesystem::path const& folder, std::filesystem::path const& written) {
  remove_result(folder, written);
  remove_file(checkpoint_path(folder));
}

}  // namespace sysid
