// Two holders exclude each other; one that was killed excludes nobody.
#include "core/system/folder_lock.hpp"

#include <doctest/doctest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <optional>
#include <string>

#include "core/system/files.hpp"
#include "temporary_folder.hpp"

using namespace sysid;

namespace {

std::string refusal(std::filesystem::path const& folder) {
  try {
    FolderLock const lock(folder);
  } catch (UserError const& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a folder has one holder at a time, and the file of the lock goes with the lock") {
  TemporaryFolder const folder;
  std::optional<FolderLock> lock(folder.path());
  CHECK(refusal(folder.path()) ==
        "another run of sysid (process " + std::to_string(getpid()) + ") writes into `" + folder.path().string() + "`");
  FolderLock moved(std::move(*lock));
  lock.reset();
  CHECK(refusal(folder.path()) != "");  // with what it was moved to
  TemporaryFolder const other;
  CHECK(refusal(other.path()) == "");
  CHECK(std::filesystem::is_empty(other.path()));
}

TEST_CASE("a lock of a killed process blocks nobody") {
  TemporaryFolder const folder;
  int ready[2];
  REQUIRE(pipe(ready) == 0);
  pid_t const child = fork();
  if (child == 0) {
    FolderLock const lock(folder.path());
    (void)!write(ready[1], ".", 1);
    for (;;) pause();
  }
  char byte;
  REQUIRE(read(ready[0], &byte, 1) == 1);
  CHECK(refusal(folder.path()).find("(process " + std::to_string(child) + ")") != std::string::npos);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  CHECK(std::filesystem::exists(folder.path() / "lock"));  // nobody has removed it
  CHECK(refusal(folder.path()) == "");
  CHECK_FALSE(std::filesystem::exists(folder.path() / "lock"));
  close(ready[0]);
  close(ready[1]);
}
