// The interrupt flag: set by the signals, cleared on request.
#include "core/system/interrupt.hpp"

#include <doctest/doctest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/system/forced_end.hpp"
#include "temporary_folder.hpp"

using namespace sysid;

TEST_CASE("Ctrl-C, SIGTERM and SIGHUP raise the flag and the program goes on") {
  install_interrupt_handlers();
  for (int const signal : {SIGINT, SIGTERM, SIGHUP}) {
    clear_interrupt();
    CHECK_FALSE(interrupt_requested());
    std::raise(signal);
    CHECK(interrupt_requested());
  }
  clear_interrupt();
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  std::signal(SIGHUP, SIG_DFL);
}

TEST_CASE("SIGHUP stays ignored where nohup(1) has said so") {
  std::signal(SIGHUP, SIG_IGN);
  install_interrupt_handlers();
  clear_interrupt();
  std::raise(SIGHUP);
  CHECK_FALSE(interrupt_requested());
  for (int const signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
}

TEST_CASE("work of which nothing is kept is left at a request, and only then") {
  clear_interrupt();
  CHECK_NOTHROW(stop_if_interrupted());
  request_interrupt();
  CHECK_THROWS_AS(stop_if_interrupted(), Interrupted);
  clear_interrupt();
}

namespace {

// Exit code of a process in which `first` arrives and, some time later, `second`; 0 where it lives on.
int exit_after(int first, std::chrono::milliseconds pause, int second) {
  pid_t const child = fork();
  if (child == 0) {
    install_interrupt_handlers();
    clear_interrupt();
    std::raise(first);
    std::this_thread::sleep_for(pause);
    std::raise(second);
    _exit(interrupt_requested() ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

TEST_CASE("one request that arrives twice is one; only Ctrl-C pressed again later ends the program") {
  using namespace std::chrono_literals;
  // What timeout(1) does: to the process and to its group.
  CHECK(exit_after(SIGTERM, 0ms, SIGTERM) == 0);
  CHECK(exit_after(SIGINT, 0ms, SIGINT) == 0);
  CHECK(exit_after(SIGTERM, 600ms, SIGTERM) == 0);
  CHECK(exit_after(SIGINT, 600ms, SIGINT) == 130);
  CHECK(exit_after(SIGTERM, 600ms, SIGINT) == 130);
}

namespace {

// Exit code of a process that hears nothing for longer than a second after the signal; 0 where it goes on.
int exit_of_deaf_work(int signal, bool keeps_something, std::vector<std::string> const& made = {}) {
  pid_t const child = fork();
  if (child == 0) {
    install_interrupt_handlers();
    clear_interrupt();
    std::optional<NothingToKeep> guard;
    if (!keeps_something) guard.emplace();
    RemovedAtForcedEnd const removed(made);
    std::raise(signal);
    std::this_thread::sleep_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(1500));
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

TEST_CASE("work of which nothing is kept ends a second after a request that it does not hear, other work goes on") {
  TemporaryFolder const work;
  auto const results = work.path() / "results", task = results / "decay", earlier = work.path() / "earlier";
  std::vector<std::string> const made = {(task / "lock").string(), task.string(), results.string(), earlier.string()};
  for (int const signal : {SIGINT, SIGTERM, SIGHUP}) {
    std::filesystem::create_directories(task);
    std::filesystem::create_directories(earlier);
    for (auto const& file : {task / "lock", earlier / "summary.json"}) std::ofstream(file) << '.';
    { RemovedAtForcedEnd const given_up(made); }
    CHECK(exit_of_deaf_work(signal, false, made) == 75);
    CHECK_FALSE(std::filesystem::exists(results));
    CHECK(std::filesystem::exists(earlier / "summary.json"));
  }
  std::filesystem::create_directories(task);
  CHECK(exit_of_deaf_work(SIGINT, true, made) == 0);
  CHECK(std::filesystem::exists(task));
  CHECK(exit_of_deaf_work(SIGTERM, true) == 0);
}

TEST_CASE("a request raises the flag as a signal does") {
  clear_interrupt();
  request_interrupt();
  CHECK(interrupt_requested());
  clear_interrupt();
  CHECK_FALSE(interrupt_requested());
}
