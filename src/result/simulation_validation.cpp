// Errors over channels; Schwarz's criterion.
#include "result/simulation_validation.hpp"

#include <algorithm>

#include "core/numeric/elementary.hpp"

namespace sysid {

std::optional<double> ValidatedStructure::percent(std::optional<double> ValidatedChannel::*error) const {
  std::optional<double> worst;
  for (ValidatedChannel const& each : channels)
    if (each.*error && each.sd > 0) worst = std::max(worst.value_or(0), 100 * *(each.*error) / each.sd);
  return worst;
}

double OutsideEquation::criterion() const { return log_likelihood - coefficients / 2.0 * elementary::log(samples); }

}  // namespace sysid
