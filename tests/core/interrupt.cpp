// The interrupt flag: set by the signals, cleared on request.
#include "core/interrupt.hpp"

#include <doctest/doctest.h>

#include <csignal>
#include <initializer_list>

using namespace sysid;

TEST_CASE("Ctrl-C and SIGTERM raise the flag and the program goes on") {
  install_interrupt_handlers();
  for (int const signal : {SIGINT, SIGTERM}) {
    clear_interrupt();
    CHECK_FALSE(interrupt_requested());
    std::raise(signal);
    CHECK(interrupt_requested());
  }
  clear_interrupt();
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

TEST_CASE("a request raises the flag as a signal does") {
  clear_interrupt();
  request_interrupt();
  CHECK(interrupt_requested());
  clear_interrupt();
  CHECK_FALSE(interrupt_requested());
}
