// For those who divide work among ranks, and threads that work for one that is within `Own`.
#pragma once
#include <cstdint>

#include "core/ranks/ranks.hpp"

namespace sysid::ranks {

/// Whether the thread is within `Own`.
bool on_its_own();

/// `gather` of the results of divided work, of ranks that all have the same in mind; where they have not they have come apart, and
/// the run ends. What it takes is learned for `worth`.
std::vector<std::string> gather_about(std::uint64_t same, std::string_view mine);

/// Whether work that takes so much longer on one rank than shared [s] is worth the exchange of so many bytes; the same on all
/// ranks. perhaps_worth: false where it is not, whatever the bytes.
bool worth(double seconds, double bytes);
bool perhaps_worth(double seconds);

}  // namespace sysid::ranks
