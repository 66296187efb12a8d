// Work in a process of its own: one that waits for a lock is given up, one that the system keeps waiting is not.
#include "data/format/own_process.hpp"

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <ctime>
#include <string>

using namespace sysid;

namespace {

constexpr std::size_t some_memory = std::size_t{1} << 24U;

void sleep_for(std::time_t seconds) {
  timespec const length{seconds, 0};
  ::nanosleep(&length, nullptr);
}

}  // namespace

TEST_CASE("a process that waits without computing is given up, and one in the state of waiting for a disk is not") {
  OwnWork const waits = in_own_process(some_memory, [] {
    ::pause();  // as for a lock that nobody gives back
    return std::string("never");
  });
  CHECK(waits.end == WorkEnd::waited);
  // Linux shows who waits for a child of vfork as it shows who waits for a disk.
  OwnWork const done = in_own_process(some_memory, [] {
    pid_t const child = ::vfork();
    if (child == 0) {
      sleep_for(3);
      ::_exit(0);
    }
    ::waitpid(child, nullptr, 0);
    return std::string("done");
  });
  REQUIRE(done.end == WorkEnd::done);
  CHECK(done.result == "done");
}
