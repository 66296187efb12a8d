// The compiler of machine code: a library of its own, loaded when it is first wanted and not before.
#pragma once
#include <string>

#include "native/loop.hpp"

namespace sysid::native {

/// The module beside the program; null where there is none that fits or it cannot be loaded. Loads it at the first call (about 11
/// ms of processor time and 60 MB of memory). May be called from several threads.
Module const* module();

/// Why there is no machine code, in words for the user; empty where `module` has one.
std::string const& why_unavailable();

}  // namespace sysid::native
