// One process at a time writes results into a folder.
#pragma once
#include <filesystem>

namespace sysid {

/// A lock on a folder, for as long as the object lives. The operating system gives it up when the process ends, however it ends:
/// the file `lock` that a killed process leaves blocks nobody. Where the file system has no locks there is none.
class FolderLock {
 public:
  /// UserError, naming the process, where another one holds it; IoError where the file `lock` cannot be made.
  explicit FolderLock(std::filesystem::path const& folder);
  ~FolderLock();
  FolderLock(FolderLock&& other) noexcept;
  FolderLock& operator=(FolderLock&&) = delete;

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

}  // namespace sysid
