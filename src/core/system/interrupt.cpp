// Signal handlers that only set a flag; Ctrl-C pressed again gives up waiting for a safe point.
#include "core/system/interrupt.hpp"

#include <sysexits.h>
#include <unistd.h>
#include <csignal>

#include <atomic>
#include <cstdint>
#include <ctime>

#include "core/system/forced_end.hpp"

namespace sysid {

namespace {

// timeout(1), shells and launchers pass one request on twice, to the program and to its process group; what arrives within this
// time of the first signal is the same request.
constexpr std::int64_t same_request_nanoseconds = 500'000'000;

// When an interruption was requested, in nanoseconds of the monotonic clock; 0 where none is. One word, since two signals may be
// handled by two threads at once.
std::atomic<std::int64_t> requested_at{0};
// The same of the first signal that ends with the process being killed.
std::atomic<std::int64_t> final_at{0};
std::atomic<bool (*)(bool)> rule{nullptr};
std::atomic<int> nothing_to_keep{0};  // how many pieces of work say so
static_assert(std::atomic<std::int64_t>::is_always_lock_free, "a signal handler may touch lock-free atomics alone");

std::int64_t nanoseconds() {
  timespec now = {};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
}

void on_signal(int signal) {
  std::int64_t const now = nanoseconds();
  std::int64_t first = 0, none = 0;
  if (signal == SIGINT || signal == SIGTERM || signal == SIGHUP) final_at.compare_exchange_strong(none, now);
  if (requested_at.compare_exchange_strong(first, now)) {
    if ((signal == SIGINT || nothing_to_keep.load() > 0) && rule.load() == nullptr) alarm(1);
    return;
  }
  // Whoever supervises the program and has no more patience sends SIGKILL: SIGTERM may come as often as it likes.
  if (signal == SIGINT && now - first > same_request_nanoseconds) _exit(130);
}

/// A second later: a step that takes long cannot be left in its middle, and nobody should wonder whether the request was heard.
void on_alarm(int) {
  if (requested_at.load() == 0) return;
  if (nothing_to_keep.load() > 0) {
    constexpr char ended[] = "\nsysid: interrupted\n";
    (void)!write(STDERR_FILENO, ended, sizeof ended - 1);
    remove_at_forced_end();
    _exit(EX_TEMPFAIL);
  }
  constexpr char words[] = "\nsysid: stopping after the step in progress; Ctrl-C again ends at once, without a new checkpoint\n";
  (void)!write(STDERR_FILENO, words, sizeof words - 1);
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
  struct sigaction later = action;
  later.sa_handler = &on_alarm;
  sigaction(SIGALRM, &later, nullptr);
  // The terminal is gone: what SIGTERM does. Under nohup(1) the signal is ignored, and stays so.
  struct sigaction before = {};
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
}

void heed_signal(int signal) {
  struct sigaction action = {};
  action.sa_handler = &on_signal;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

bool interrupt_heard() { return requested_at.load(std::memory_order_relaxed) != 0; }
bool interrupt_requested() {
  auto const requested = rule.load(std::memory_order_relaxed);
  return requested == nullptr ? interrupt_heard() : requested(interrupt_heard());
}
bool interrupt_is_final() { return final_at.load(std::memory_order_relaxed) != 0; }
double seconds_since_final_interrupt() {
  return interrupt_is_final() ? 1e-9 * static_cast<double>(nanoseconds() - final_at.load()) : 0;
}
void set_interruption(bool (*requested)(bool heard)) { rule.store(requested); }
void request_interrupt() {
  std::int64_t none = 0;
  requested_at.compare_exchange_strong(none, nanoseconds());
}
void stop_if_interrupted() {
  if (interrupt_requested()) throw Interrupted();
}
NothingToKeep::NothingToKeep() { ++nothing_to_keep; }
NothingToKeep::~NothingToKeep() { --nothing_to_keep; }
void clear_interrupt() {
  requested_at.store(0);
  final_at.store(0);
}

}  // namespace sysid
