// Whether messages may be coloured.
#pragma once

namespace sysid {

/// Whether standard error is a terminal that shows colours, and nobody has asked for none (https://no-color.org).
bool coloured_messages();

}  // namespace sysid
