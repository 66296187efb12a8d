// For threads that work for one that is within `Own`.
#pragma once
#include "core/ranks/ranks.hpp"

namespace sysid::ranks {

/// Whether the thread is within `Own`.
bool on_its_own();

}  // namespace sysid::ranks
