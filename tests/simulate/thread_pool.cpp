// The pool runs every task once, from one or several callers, and passes exceptions on.
#include "simulate/thread_pool.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

using namespace sysid;

TEST_CASE("every task runs once, in every one of many rounds") {
  ThreadPool pool(4);
  CHECK(pool.threads() == 4);
  for (int round = 0; round < 200; ++round) {
    std::vector<std::atomic<int>> ran(17);
    pool.run(17, [&](int i) { ++ran[static_cast<std::size_t>(i)]; });
    for (std::atomic<int> const& count : ran) CHECK(count == 1);
  }
}

TEST_CASE("two callers at once both get their tasks done") {
  ThreadPool pool(3);
  std::atomic<int> total = 0;
  auto const caller = [&] {
    for (int round = 0; round < 50; ++round) pool.run(9, [&](int) { ++total; });
  };
  std::thread other(caller);
  caller();
  other.join();
  CHECK(total == 2 * 50 * 9);
}

TEST_CASE("a task may give the pool tasks of its own") {
  ThreadPool pool(3);
  std::atomic<int> total = 0;
  for (int round = 0; round < 50; ++round) pool.run(4, [&](int) { pool.run(5, [&](int) { ++total; }); });
  CHECK(total == 50 * 4 * 5);
}

TEST_CASE("an exception of a task reaches the caller, and the pool goes on") {
  ThreadPool pool(2);
  CHECK_THROWS_AS(pool.run(5,
                           [](int i) {
                             if (i == 3) throw std::runtime_error("three");
                           }),
                  std::runtime_error);
  int ran = 0;
  pool.run(1, [&](int) { ++ran; });
  CHECK(ran == 1);
}
