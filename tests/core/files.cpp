// Files: whole or not at all, and failures that name path and reason.
#include "core/system/files.hpp"

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <fstream>

#include "core/text/diagnostic.hpp"
#include "temporary_folder.hpp"

using namespace sysid;
namespace fs = std::filesystem;

namespace {

std::string message_of(auto const& action) {
  try {
    action();
  } catch (IoError const& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace

TEST_CASE("what is written is read back, byte for byte") {
  TemporaryFolder const folder;
  std::string bytes = "a\r\nb";
  bytes += '\0';
  bytes += std::string(200000, '\xFF');
  write_file(folder.path() / "x", bytes);
  CHECK(read_file(folder.path() / "x") == bytes);
  write_file(folder.path() / "x", "short");
  CHECK(read_file(folder.path() / "x") == "short");
  CHECK_FALSE(fs::exists(folder.path() / "x.partial"));
}

TEST_CASE("a file that is not there is refused with path and reason") {
  CHECK(message_of([] { read_file("/nonexistent/x.csv"); }) == "cannot read `/nonexistent/x.csv`: no such file or directory");
  CHECK(message_of([] { write_file("/nonexistent/x.csv", ""); }) == "cannot write `/nonexistent/x.csv`: no such file or directory");
}

TEST_CASE("a folder is not a file") {
  TemporaryFolder const folder;
  CHECK(message_of([&] { read_file(folder.path()); }) == "cannot read `" + folder.path().string() + "`: is a directory");
  CHECK(message_of([&] { write_file(folder.path(), "x"); }).find("is a directory") != std::string::npos);
  CHECK(fs::is_directory(folder.path()));
}

TEST_CASE("a full device is named, and stays a device") {
  CHECK(message_of([] { write_file("/dev/full", "x"); }) == "cannot write `/dev/full`: no space left on device");
  CHECK(fs::is_character_file("/dev/full"));
}

TEST_CASE("a write that fails half-way keeps the old file and removes the temporary one") {
  TemporaryFolder const folder;
  write_file(folder.path() / "x", "old");
  struct rlimit before = {};
  getrlimit(RLIMIT_FSIZE, &before);
  struct rlimit limit = before;
  limit.rlim_cur = 1000;
  auto const handler = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &limit);
  std::string const message = message_of([&] { write_file(folder.path() / "x", std::string(2000, 'n')); });
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  CHECK(message == "cannot write `" + (folder.path() / "x").string() + "`: file too large");
  CHECK(read_file(folder.path() / "x") == "old");
  CHECK_FALSE(fs::exists(folder.path() / "x.partial"));
}

TEST_CASE("a symbolic link is followed, not replaced") {
  TemporaryFolder const folder;
  write_file(folder.path() / "real", "old");
  fs::create_symlink("real", folder.path() / "link");
  write_file(folder.path() / "link", "new");
  CHECK(fs::is_symlink(folder.path() / "link"));
  CHECK(read_file(folder.path() / "real") == "new");
}

TEST_CASE("permissions are kept") {
  TemporaryFolder const folder;
  write_file(folder.path() / "x", "old");
  fs::permissions(folder.path() / "x", fs::perms::owner_read | fs::perms::owner_write);
  write_file(folder.path() / "x", "new");
  CHECK(fs::status(folder.path() / "x").permissions() == (fs::perms::owner_read | fs::perms::owner_write));
}

TEST_CASE("a folder is made with those above it; a file in its place is an error") {
  TemporaryFolder const folder;
  make_folder(folder.path() / "a" / "b");
  make_folder(folder.path() / "a" / "b");
  CHECK(fs::is_directory(folder.path() / "a" / "b"));
  write_file(folder.path() / "file", "");
  CHECK(message_of([&] { make_folder(folder.path() / "file"); }).find("not a directory") != std::string::npos);
}

TEST_CASE("removing what is not there is no error") {
  TemporaryFolder const folder;
  write_file(folder.path() / "x", "");
  remove_file(folder.path() / "x");
  CHECK_FALSE(fs::exists(folder.path() / "x"));
  CHECK(message_of([&] { remove_file(folder.path() / "x"); }) == "no error");
}

TEST_CASE("what may have no end or no beginning is no file to read whole") {
  TemporaryFolder const folder;
  std::filesystem::path const pipe = folder.path() / "pipe", file = folder.path() / "file";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  for (std::filesystem::path const& path : {std::filesystem::path("/dev/zero"), pipe}) {
    CAPTURE(path.string());
    try {
      read_regular_file(path);
      FAIL("read");
    } catch (IoError const& error) {
      CHECK(std::string(error.what()) == "cannot read `" + path.string() + "`: it is a device or a pipe, not a file");
    }
  }
  CHECK_THROWS_AS(read_regular_file(folder.path()), IoError);
  write_file(file, "abc");
  CHECK(read_regular_file(file) == "abc");
  CHECK(regular_file_size(file) == 3);
  CHECK(read_regular_file("/proc/self/stat") != "");  // a file of which the system tells no size
}
