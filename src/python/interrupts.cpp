// The handler of the command line also ends the program at the second Ctrl-C, which is not ours to end here.
#include "python/interrupts.hpp"

#include <csignal>

#include <mutex>

#include "core/system/interrupt.hpp"

namespace sysid::python {
namespace {

std::mutex mutex;
int running = 0;
struct sigaction before;

void on_interrupt(int) { request_interrupt(); }

}  // namespace

Interrupts::Interrupts() {
  std::lock_guard const lock(mutex);
  if (running++ > 0) return;
  clear_interrupt();
  struct sigaction action = {};
  action.sa_handler = &on_interrupt;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, &before);
  if (before.sa_handler == SIG_IGN) sigaction(SIGINT, &before, nullptr);
}

Interrupts::~Interrupts() {
  std::lock_guard const lock(mutex);
  if (--running == 0) sigaction(SIGINT, &before, nullptr);
}

bool Interrupts::take() {
  bool const requested = interrupt_requested();
  if (requested) clear_interrupt();
  return requested;
}

}  // namespace sysid::python
