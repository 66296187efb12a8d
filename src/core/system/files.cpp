// Files by system calls: every result is checked, since a full disk may show itself as late as fsync or close.
#include "core/system/files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <system_error>
#include <utility>

#include "core/text/diagnostic.hpp"
#include "core/text/utf8.hpp"

namespace sysid {
namespace {

bool left = false;

}  // namespace

void leave_files_to_another() { left = true; }
bool files_are_left() { return left; }

std::vector<std::string> files_beside(std::filesystem::path const& path) {
  std::vector<std::string> names;
  std::error_code ignored;
  std::filesystem::path const folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  for (auto const& entry : std::filesystem::directory_iterator(folder, ignored))
    if (entry.is_regular_file(ignored)) names.push_back((path.parent_path() / entry.path().filename()).string());
  std::sort(names.begin(), names.end());
  return names;
}

namespace {

/// The system's words, as the rest of our messages: lower case.
std::string reason(int error) {
  std::string text = std::generic_category().message(error);
  if (text.size() > 1 && text[0] >= 'A' && text[0] <= 'Z' && text[1] >= 'a' && text[1] <= 'z')
    text[0] = static_cast<char>(text[0] - 'A' + 'a');
  return text;
}

std::string help_to_read(std::filesystem::path const& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return fmt::format("`{}` is a folder: give a file in it", path.string());
  std::string const guess = did_you_mean(path.string(), files_beside(path));
  return guess.empty() ? "check the path and the permissions" : guess;
}

std::string help_to_write(std::filesystem::path const& path, int error) {
  std::error_code ignored;
  std::filesystem::path const folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  if (error == ENOENT && !std::filesystem::exists(folder, ignored))
    return fmt::format("there is no folder `{}`: create it, or give another one", folder.string());
  if (error == EISDIR) return fmt::format("`{}` is a folder: give a file in it", path.string());
  if (error == ENOTDIR || error == EEXIST) return "a part of the path is a file, not a folder: give another path";
  if (error == EACCES || error == EPERM || error == EROFS) return "check the permissions, or give another folder";
  return "check that the folder is writable and the disk has free space";
}

[[noreturn]] void fail(std::string_view what, std::filesystem::path const& path, int error) {
  std::string const help = what == "read" ? help_to_read(path) : help_to_write(path, error);
  throw IoError(fmt::format("cannot {} `{}`: {}", what, path.string(), reason(error)), help);
}

int open_file(std::filesystem::path const& path, int flags) {
  int descriptor;
  do descriptor = ::open(path.c_str(), flags | O_CLOEXEC, 0666);
  while (descriptor < 0 && errno == EINTR);
  return descriptor;
}

/// 0, or the error of the first call that failed. Always closes.
int write_and_close(int descriptor, std::string_view bytes, bool durable) {
  int error = 0;
  while (!bytes.empty() && error == 0) {
    ssize_t const written = ::write(descriptor, bytes.data(), bytes.size());
    if (written >= 0)
      bytes.remove_prefix(static_cast<std::size_t>(written));
    else if (errno != EINTR)
      error = errno;
  }
  if (error == 0 && durable && ::fsync(descriptor) != 0) error = errno;
  // After EINTR the descriptor is closed all the same (Linux).
  if (::close(descriptor) != 0 && errno != EINTR && error == 0) error = errno;
  return error;
}

/// Flushed to the disk; 0, or the error of the first call that failed, after which nothing is there. mode: of the file whose place
/// it takes: whoever could read the old bytes can read the new, and no one else.
int write_partial(std::filesystem::path const& partial, std::string_view bytes, std::optional<mode_t> mode) {
  int const descriptor = open_file(partial, O_WRONLY | O_CREAT | O_TRUNC);
  if (descriptor < 0) return errno;
  if (mode) (void)::fchmod(descriptor, *mode & 07777U);
  int const error = write_and_close(descriptor, bytes, true);
  if (error != 0) ::unlink(partial.c_str());
  return error;
}

}  // namespace

namespace {

/// Closes it.
std::string read_and_close(int descriptor, std::filesystem::path const& path, std::size_t most) {
  std::string bytes;
  struct stat facts = {};
  if (::fstat(descriptor, &facts) == 0 && facts.st_size > 0) bytes.reserve(std::min(most, static_cast<std::size_t>(facts.st_size)));
  char buffer[1 << 16];
  int error = 0;
  while (bytes.size() < most) {
    ssize_t const got = ::read(descriptor, buffer, sizeof buffer);
    if (got == 0) break;
    if (got > 0) {
      bytes.append(buffer, static_cast<std::size_t>(got));
    } else if (errno != EINTR) {
      error = errno;
      break;
    }
  }
  ::close(descriptor);
  if (error != 0) fail("read", path, error);
  return bytes;
}

/// Open, and its size; without waiting for whoever writes into a pipe.
std::pair<int, std::uintmax_t> open_regular(std::filesystem::path const& path) {
  int const descriptor = open_file(path, O_RDONLY | O_NONBLOCK);
  if (descriptor < 0) fail("read", path, errno);
  struct stat facts = {};
  int const error = ::fstat(descriptor, &facts) == 0 ? 0 : errno;
  bool const regular = error == 0 && S_ISREG(facts.st_mode);
  if (regular) return {descriptor, static_cast<std::uintmax_t>(facts.st_size)};
  ::close(descriptor);
  if (error != 0) fail("read", path, error);
  if (S_ISDIR(facts.st_mode)) fail("read", path, EISDIR);
  throw IoError(fmt::format("cannot read `{}`: it is a device or a pipe, not a file", path.string()),
                "write what comes from it into a file and give that file");
}

}  // namespace

std::string read_file(std::filesystem::path const& path, std::size_t most) {
  int const descriptor = open_file(path, O_RDONLY);
  if (descriptor < 0) fail("read", path, errno);
  return read_and_close(descriptor, path, most);
}

std::string read_regular_file(std::filesystem::path const& path, std::size_t most) {
  return read_and_close(open_regular(path).first, path, most);
}

std::uintmax_t regular_file_size(std::filesystem::path const& path) {
  auto const [descriptor, size] = open_regular(path);
  ::close(descriptor);
  return size;
}

std::filesystem::path partial_path(std::filesystem::path path) { return path += ".partial"; }

void write_file(std::filesystem::path const& path, std::string_view bytes) {
  if (left) return;
  std::filesystem::path target = path;
  struct stat facts = {};
  bool const there = ::stat(path.c_str(), &facts) == 0;
  if (there) {
    if (!S_ISREG(facts.st_mode) && !S_ISDIR(facts.st_mode)) {
      // A device or pipe keeps its name: renaming over /dev/null would replace it.
      int const descriptor = open_file(path, O_WRONLY);
      if (descriptor < 0) fail("write", path, errno);
      if (int const error = write_and_close(descriptor, bytes, false)) fail("write", path, error);
      return;
    }
    std::error_code ignored;
    std::filesystem::path const real = std::filesystem::canonical(path, ignored);
    if (!ignored) target = real;
  }
  std::filesystem::path const partial = partial_path(target);
  int error = write_partial(partial, bytes, there ? std::optional(facts.st_mode) : std::nullopt);
  if (error == 0 && ::rename(partial.c_str(), target.c_str()) != 0) {
    error = errno;
    ::unlink(partial.c_str());
  }
  if (error != 0) fail("write", path, error);
  flush_folder(target.parent_path());
}

void require_no_folder(std::filesystem::path const& path) {
  if (struct stat facts = {}; ::stat(path.c_str(), &facts) == 0 && S_ISDIR(facts.st_mode)) fail("write", path, EISDIR);
}

void require_removable(std::filesystem::path const& path) {
  std::filesystem::path const folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  if (::faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) != 0) fail("remove", path, errno);
}

void stage_file(std::filesystem::path const& path, std::string_view bytes) {
  if (left) return;
  struct stat facts = {};
  require_no_folder(path);
  bool const regular = ::stat(path.c_str(), &facts) == 0 && S_ISREG(facts.st_mode);
  if (int const error = write_partial(partial_path(path), bytes, regular ? std::optional(facts.st_mode) : std::nullopt))
    fail("write", path, error);
}

void rename_staged(std::filesystem::path const& path) {
  if (left) return;
  if (::rename(partial_path(path).c_str(), path.c_str()) != 0 && errno != ENOENT) fail("write", path, errno);
}

void flush_folder(std::filesystem::path const& folder) {
  if (left) return;
  int const descriptor = open_file(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY);
  if (descriptor < 0) return;
  (void)::fsync(descriptor);
  ::close(descriptor);
}

void make_folder(std::filesystem::path const& path) {
  if (left) return;
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) fail("create the folder", path, error.value());
  if (!std::filesystem::is_directory(path)) fail("create the folder", path, ENOTDIR);
}

IoError path_error(std::filesystem::filesystem_error const& error) {
  std::string const path = error.path1().string();
  std::string const shown = path.size() > 100 ? path.substr(0, character_begin(path, 100)) + "..." : path;
  return IoError(fmt::format("cannot use the path `{}`: {}", shown, reason(error.code().value())),
                 error.code().value() == ENAMETOOLONG ? "use a shorter name" : "check the path and the permissions");
}

IoError no_results_folder(std::filesystem::path const& path) {
  std::error_code ignored;
  std::filesystem::path const bare = path.has_filename() ? path : path.parent_path();
  if (std::filesystem::is_regular_file(bare, ignored))
    return IoError(fmt::format("`{}` is a file, not a folder of results", path.string()),
                   "give the folder of its results, which `sysid run` writes: `results`, unless `-o` names another");
  std::vector<std::string> folders;
  for (auto const& entry : std::filesystem::directory_iterator(bare.has_parent_path() ? bare.parent_path() : ".", ignored))
    if (entry.is_directory(ignored)) folders.push_back((bare.parent_path() / entry.path().filename()).string());
  std::sort(folders.begin(), folders.end());
  std::string const guess = did_you_mean(bare.string(), folders);
  return IoError(
      fmt::format("there is no folder `{}`", path.string()),
      !guess.empty() ? guess : "run the tasks first, `sysid run FILE`: results go to the folder `results`, or to that of `-o`");
}

void remove_file(std::filesystem::path const& path) {
  if (left) return;
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) fail("remove", path, errno);
}

}  // namespace sysid
