// Errors over channels.
#include "result/simulation_validation.hpp"

#include <algorithm>

namespace sysid {

std::optional<double> ValidatedStructure::percent(std::optional<double> ValidatedChannel::*error) const {
  std::optional<double> worst;
  for (ValidatedChannel const& each : channels)
    if (each.*error && each.sd > 0) worst = std::max(worst.value_or(0), 100 * *(each.*error) / each.sd);
  return worst;
}

}  // namespace sysid
