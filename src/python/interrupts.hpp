// Ctrl-C while the engine works: each call that it reaches learns of it when it ends, and so does the main thread.
#pragma once

#include <cstdint>

#include "core/system/interrupt.hpp"
#include "embed/errors.hpp"

namespace sysid::python {

/// For the time of a call, without the interpreter lock. Calls of several threads share the handler; the last one to end gives
/// Python's back. What the engine computes while a request is pending breaks off, so a call that begins then waits until those that
/// the request was for have ended. One within another call of its thread cannot wait, and begins as interrupted.
class Interrupts {
 public:
  Interrupts();
  ~Interrupts();
  Interrupts(Interrupts const&) = delete;
  /// Whether Ctrl-C has been pressed since this call began, whoever else has heard it: nothing computed is to be trusted as whole.
  bool requested();
  /// Throws Interrupted where it was.
  void stop_if_requested() {
    if (requested()) throw Interrupted();
  }

 private:
  bool main_, nested_;
  std::uint64_t start_, seen_;  // how many there were
};

/// What `work` returns; Interrupted where Ctrl-C came before it ended, and its errors raised, with places in `source`.
template <class Work>
auto interruptible(Source const& source, Work&& work) {
  Interrupts interrupts;
  interrupts.stop_if_requested();
  auto result = embed::guarded(source, [&] {
    try {
      return work();
    } catch (Interrupted const&) {
      interrupts.requested();  // seen
      throw;
    }
  });
  interrupts.stop_if_requested();
  return result;
}

}  // namespace sysid::python
