// Ctrl-C, SIGTERM and SIGHUP as a flag that long jobs read at safe points.
#pragma once

namespace sysid {

/// From here on; Ctrl-C pressed again, half a second and more after the first request, ends the program at once. At the prompt,
/// which has a handler of its own, Ctrl-C never does.
void install_interrupt_handlers();
bool interrupt_requested();
/// What a signal does; also for tests (`--interrupt-after`).
void request_interrupt();
void clear_interrupt();

/// Work of which nothing is kept was given up on request.
struct Interrupted {};
/// Throws Interrupted when an interruption is requested: in long loops over data that are read or made. Not where results are
/// finished and written, which goes on after a request.
void stop_if_interrupted();

}  // namespace sysid
