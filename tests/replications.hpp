// How often a statistical test repeats itself.
#pragma once
#include <cstdlib>

namespace sysid {

/// What SYSID_REPLICATIONS asks for, else what an ordinary run of the tests can afford.
inline int replications(int unless_asked) {
  char const* const asked = std::getenv("SYSID_REPLICATIONS");
  return asked != nullptr ? std::atoi(asked) : unless_asked;
}

}  // namespace sysid
