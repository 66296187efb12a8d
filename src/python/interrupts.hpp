// Ctrl-C while the engine works: a request to stop, which Python learns of when the call returns.
#pragma once

namespace sysid::python {

/// For the time of a call. Calls of several threads share the handler; the last one to end gives Python's back.
class Interrupts {
 public:
  Interrupts();
  ~Interrupts();
  Interrupts(Interrupts const&) = delete;
  /// Whether one was requested since the first of the running calls began; forgets it.
  static bool take();
};

}  // namespace sysid::python
