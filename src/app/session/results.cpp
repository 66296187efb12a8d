// Claiming result folders.
#include "app/session/results.hpp"

#include <fmt/format.h>

#include "core/system/files.hpp"
#include "report/file/task_folder.hpp"

namespace sysid {

std::filesystem::path checkpoint_path(std::filesystem::path const& folder) { return folder / "checkpoint.cbor"; }

bool complete(std::filesystem::path const& folder) {
  return std::filesystem::exists(folder / "summary.json") && !std::filesystem::exists(checkpoint_path(folder));
}

UserError older_version(std::filesystem::path const& folder) {
  return UserError(result_error("", fmt::format("`{}` was written by an older version of sysid", folder.string()), run_again()));
}

void claim_results(std::filesystem::path const& folder, RunOptions const& options) {
  if (options.resume) {
    make_folder(folder);  // what is there stays until the run has shown that it goes on with it
  } else {
    if (std::filesystem::exists(checkpoint_path(folder)) && !options.force)
      throw UserError(result_error("", fmt::format("`{}` holds an interrupted run", folder.string()), resume_or_replace()));
    prepare_result(folder, options.force);
    remove_file(checkpoint_path(folder));
  }
  // A byte, since a full disk takes empty files.
  write_file(folder / "claim", ".");
  remove_file(folder / "claim");
}

}  // namespace sysid
