// Ctrl-C, SIGTERM and SIGHUP as a flag that long jobs read at safe points.
#pragma once

namespace sysid {

/// From here on; Ctrl-C pressed again, half a second and more after the first request, ends the program at once. At the prompt,
/// which has a handler of its own, Ctrl-C never does.
void install_interrupt_handlers();
/// Another signal that asks for the same, without the end being near.
void heed_signal(int signal);
bool interrupt_requested();
/// What a signal does; also for tests (`--interrupt-after`).
void request_interrupt();
void clear_interrupt();

/// Of a process that stops together with others: whether it has been asked itself; whether by a signal after which it is soon
/// killed, and since when [s].
bool interrupt_heard();
bool interrupt_is_final();
double seconds_since_final_interrupt();
/// From here on `interrupt_requested` is what this makes of `interrupt_heard`, and who asked is not answered in words.
void set_interruption(bool (*requested)(bool heard));

/// Work of which nothing is kept was given up on request.
struct Interrupted {};
/// Throws Interrupted when an interruption is requested: in long loops over data that are read or made. Not where results are
/// finished and written, which goes on after a request.
void stop_if_interrupted();

/// While one lives, nothing would be kept of the work in progress, and nothing of it is half written: if it has not stopped a
/// second after Ctrl-C, SIGTERM or SIGHUP, the program ends with exit code 75. For work with steps that cannot be left in their
/// middle, such as filling gigabytes. Without effect where `install_interrupt_handlers` was not called, and among ranks.
class NothingToKeep {
 public:
  NothingToKeep();
  ~NothingToKeep();
  NothingToKeep(NothingToKeep const&) = delete;
  NothingToKeep& operator=(NothingToKeep const&) = delete;
};

}  // namespace sysid
