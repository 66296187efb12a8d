// Folders of results before the work begins: reserved and checked to be writable; earlier results are kept until there are new
// ones.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "app/session/options.hpp"
#include "core/system/folder_lock.hpp"
#include "core/system/forced_end.hpp"
#include "core/text/diagnostic.hpp"

namespace sysid {

/// A folder of results, reserved for a run as long as this lives. What it holds stays: the run replaces it when it has something of
/// its own to keep.
class ClaimedFolder {
 public:
  /// Makes the folder ready and proves that it can be written. UserError when another process writes into it, or when it holds
  /// results already and neither force nor resume is asked for; IoError when it cannot be written: before hours of sampling, not
  /// after.
  ClaimedFolder(std::filesystem::path const& folder, RunOptions const& options);

 private:
  /// Removes the folders that it has made, where nothing has come into them.
  struct MadeFolders {
    explicit MadeFolders(std::filesystem::path const& folder);
    ~MadeFolders();
    MadeFolders(MadeFolders&&) = default;
    MadeFolders& operator=(MadeFolders&&) = delete;
    void remove_empty() const;
    std::vector<std::string> with_lock(std::filesystem::path const& folder) const;
    std::vector<std::filesystem::path> paths;  // the innermost first
  };
  MadeFolders made_;
  FolderLock lock_;
  RemovedAtForcedEnd removed_;  // the same, where the program is ended by a signal
};

/// Given up in reverse: the first claim may have made the folder that all lie in.
struct ClaimedFolders {
  ClaimedFolders() = default;
  ClaimedFolders(ClaimedFolders const&) = delete;
  ~ClaimedFolders() {
    while (!folders.empty()) folders.pop_back();
  }
  std::vector<ClaimedFolder> folders;
};

/// Removes results and checkpoint of an earlier run, whose place `written`, a file in the folder, takes.
void remove_earlier(std::filesystem::path const& folder, std::filesystem::path const& written);

std::filesystem::path checkpoint_path(std::filesystem::path const& folder);

/// Whether a task ended there (a summary without a checkpoint).
bool complete(std::filesystem::path const& folder);

}  // namespace sysid
