// Ctrl-C and SIGTERM as a flag that long jobs read at safe points; Ctrl-C pressed again, half a second and more later, ends the
// program at once.
#pragma once

namespace sysid {

void install_interrupt_handlers();
bool interrupt_requested();
/// What a signal does; also for tests (`--interrupt-after`).
void request_interrupt();
void clear_interrupt();

}  // namespace sysid
