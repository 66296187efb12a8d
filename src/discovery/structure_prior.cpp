// Odds of one term, once for each.
#include "discovery/structure_prior.hpp"

#include <algorithm>

#include "core/numeric/elementary.hpp"

namespace sysid {
namespace {

constexpr double expected_terms = 2;
constexpr double most_probable = 0.5;  // of a term, where few are offered

}  // namespace

double log_structure_prior(int offered, int taken) {
  if (offered <= 0 || taken <= 0) return 0;
  double const probability = std::min(expected_terms / offered, most_probable);
  return taken * elementary::log(probability / (1 - probability));
}

}  // namespace sysid
