// Where simulations failed, in words that are short enough for a message.
#pragma once
#include <string>

#include "core/system/ledger.hpp"

namespace sysid {

/// "non-finite in `y^3` (duffing.sysid:10:27) at t = 0.1 s" of up to three places, the most frequent first; empty where none was
/// looked into. Only the first failures are: they are examples, their counts say little.
std::string failed_places(Ledger const& ledger);

}  // namespace sysid
