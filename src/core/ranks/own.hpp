// For those who divide work among ranks, and threads that work for one that is within `Own`.
#pragma once
#include <cstdint>

#include "core/ranks/ranks.hpp"

namespace sysid::ranks {

/// Whether the thread is within `Own`.
bool on_its_own();

/// `gather`, of ranks that all have the same in mind; where they have not they have come apart, and the run ends.
std::vector<std::string> gather_about(std::uint64_t same, std::string_view mine);

}  // namespace sysid::ranks
