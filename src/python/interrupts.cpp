// The handler of the command line also ends the program at the second Ctrl-C, which is not ours to end here.
//
// One flag tells all loops of the engine to break off (core/system/interrupt.hpp). It stays set until every call that was running
// has ended, and each of them compares the number of requests with that at its own start: were it a flag to be taken, the first
// call to end would take it, and the others would return what they had not finished.
#include "python/interrupts.hpp"

#include <Python.h>
#include <pthread.h>
#include <unistd.h>
#include <csignal>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <new>

namespace sysid::python {
namespace {

std::atomic<std::uint64_t> requests{0};
std::atomic<int> main_inside{0};  // calls of the main thread, one within another
static_assert(std::atomic<std::uint64_t>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "a signal handler may touch lock-free atomics alone");

/// Guarded by its mutex.
struct Calls {
  std::mutex mutex;
  std::condition_variable ended;
  int present = 0;  // with those that wait: the handler is ours
  int running = 0;
  struct sigaction before = {};
};

Calls& calls() {
  static Calls& all = *new Calls;  // never destroyed: threads may still end when the program does
  return all;
}

thread_local int depth = 0;

void on_interrupt(int) {
  request_interrupt();  // first: a call that counts as begun after this request must not see its flag
  requests.fetch_add(1);
  // In a call, the main thread sees the number. Elsewhere it waits for another thread, or is on with something else: Python's own
  // handler is due. Safe in a handler, and without the interpreter lock.
  if (main_inside.load() == 0) PyErr_SetInterrupt();
}

/// Those of the main thread where Python also has its handler: there alone signals become exceptions.
bool in_main_thread() { return gettid() == getpid(); }

bool ours(struct sigaction const& action) { return action.sa_handler == &on_interrupt; }

/// What Python waits for ends at a signal. Files that the engine reads and writes are finished before it looks.
void install() {
  struct sigaction action = {};
  action.sa_handler = &on_interrupt;
  action.sa_flags = main_inside.load() > 0 ? SA_RESTART : 0;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
}

void install_first(Calls& all) {
  sigaction(SIGINT, nullptr, &all.before);
  if (all.before.sa_handler != SIG_IGN) install();
}

void install_again() {
  struct sigaction now = {};
  sigaction(SIGINT, nullptr, &now);
  if (ours(now)) install();
}

void give_back(Calls const& all) {
  struct sigaction now = {};
  sigaction(SIGINT, nullptr, &now);
  if (ours(now)) sigaction(SIGINT, &all.before, nullptr);  // else a program has set another one meanwhile
}

/// A forked process has none of the threads whose calls are running.
void forget_calls() {
  Calls& all = calls();
  bool const held = all.present > 0;
  struct sigaction const before = all.before;
  new (&all) Calls;  // its mutex is held by the thread that forked
  all.before = before;
  if (held) give_back(all);
  main_inside = 0;
  depth = 0;
  clear_interrupt();
}

void follow_forks() {
  static int const followed = pthread_atfork([] { calls().mutex.lock(); }, [] { calls().mutex.unlock(); }, &forget_calls);
  (void)followed;
}

}  // namespace

Interrupts::Interrupts() : main_(in_main_thread()), nested_(depth > 0) {
  follow_forks();
  Calls& all = calls();
  std::unique_lock lock(all.mutex);
  ++depth;
  start_ = seen_ = requests.load();
  if (nested_) return;
  if (main_) main_inside.fetch_add(1);
  if (all.present++ == 0)
    install_first(all);
  else if (main_)
    install_again();
  while (interrupt_requested() && all.running > 0 && requests.load() == start_)
    all.ended.wait_for(lock, std::chrono::milliseconds(20));
  // Before the number is compared: a request after this one is for this call.
  if (all.running++ == 0) clear_interrupt();
}

Interrupts::~Interrupts() {
  Calls& all = calls();
  std::lock_guard const lock(all.mutex);
  if (depth > 0) --depth;
  if (nested_ || all.present == 0) return;
  if (main_) {
    main_inside.fetch_sub(1);
    if (requests.load() != seen_) PyErr_SetInterrupt();  // it came too late for this call to tell
  }
  if (--all.running == 0) {
    clear_interrupt();
    all.ended.notify_all();
  }
  if (--all.present == 0)
    give_back(all);
  else if (main_)
    install_again();
}

bool Interrupts::requested() {
  seen_ = requests.load();
  return seen_ != start_ || interrupt_requested();  // the flag stays set while this call runs
}

}  // namespace sysid::python
