// Signal handlers that only set a flag; the second signal gives up waiting for a safe point.
#include "core/interrupt.hpp"

#include <unistd.h>
#include <csignal>

#include <atomic>

namespace sysid {

namespace {

std::atomic<bool> requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may touch lock-free atomics alone");

void on_signal(int) {
  if (requested.exchange(true)) _exit(130);
}

}  // namespace

void install_interrupt_handlers() {
  struct sigaction action = {};
  action.sa_handler = &on_signal;
  // Reads and writes go on: files are finished before the flag is looked at.
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupt_requested() { return requested.load(std::memory_order_relaxed); }
void request_interrupt() { requested.store(true); }
void clear_interrupt() { requested.store(false); }

}  // namespace sysid
