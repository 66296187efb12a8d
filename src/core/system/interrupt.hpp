// Ctrl-C and SIGTERM as a flag that long jobs read at safe points.
#pragma once

namespace sysid {

/// From here on; Ctrl-C pressed again, half a second and more after the first request, ends the program at once. At the prompt,
/// which has a handler of its own, Ctrl-C never does.
void install_interrupt_handlers();
bool interrupt_requested();
/// What a signal does; also for tests (`--interrupt-after`).
void request_interrupt();
void clear_interrupt();

}  // namespace sysid
