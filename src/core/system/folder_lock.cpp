// flock(2) on a file in the folder. The file is removed with the lock held, so a process that has opened it in the meantime holds a
// lock on a file without a name: it finds another file, or none, under the name and opens that one.
#include "core/system/folder_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "core/system/files.hpp"
#include "core/text/diagnostic.hpp"

namespace sysid {
namespace {

/// " (process 1234)", as the holder wrote it; empty where it could not.
std::string holder(int descriptor) {
  char text[16] = {};
  ssize_t const size = ::pread(descriptor, text, sizeof text - 1, 0);
  std::string digits;
  for (ssize_t i = 0; i < size && text[i] >= '0' && text[i] <= '9'; ++i) digits += text[i];
  return digits.empty() ? "" : fmt::format(" (process {})", digits);
}

UserError in_use(std::filesystem::path const& folder, int descriptor) {
  return UserError({Severity::error,
                    "",
                    fmt::format("another run of sysid{} writes into `{}`", holder(descriptor), folder.string()),
                    std::nullopt,
                    {},
                    "wait until it has ended, or write elsewhere with -o DIR"});
}

bool still_named(int descriptor, std::filesystem::path const& path) {
  struct stat held = {}, named = {};
  return ::fstat(descriptor, &held) == 0 && ::stat(path.c_str(), &named) == 0 && held.st_dev == named.st_dev &&
         held.st_ino == named.st_ino;
}

}  // namespace

FolderLock::FolderLock(std::filesystem::path const& folder) : path_(folder / "lock") {
  if (files_are_left()) return;
  for (;;) {
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    if (descriptor_ < 0) {
      if (errno == EINTR) continue;
      throw IoError(fmt::format("cannot write `{}`: {}", path_.string(), std::generic_category().message(errno)),
                    "check that the folder is writable and the disk has free space");
    }
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) {
      if (still_named(descriptor_, path_)) break;
    } else if (errno == EWOULDBLOCK) {
      UserError const error = in_use(folder, descriptor_);
      ::close(descriptor_);
      throw error;
    } else if (errno != EINTR) {
      break;  // a file system without locks
    }
    ::close(descriptor_);
  }
  // For the message alone: where it cannot be written the lock holds all the same.
  std::string const process = std::to_string(::getpid()) + "\n";
  (void)!::ftruncate(descriptor_, 0);
  (void)!::pwrite(descriptor_, process.data(), process.size(), 0);
}

FolderLock::~FolderLock() {
  if (descriptor_ < 0) return;
  ::unlink(path_.c_str());
  ::close(descriptor_);
}

FolderLock::FolderLock(FolderLock&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

}  // namespace sysid
