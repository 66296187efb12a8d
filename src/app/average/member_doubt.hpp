// What is wrong with one fit of an average, by its part in it.
#pragma once
#include "core/text/diagnostic.hpp"

namespace sysid {

/// The severity of `from_doubtful_fit` of a member with this weight. By a failed fit a weight may be small that should not be: it
/// stays a warning. What only warns makes no weight smaller by a million: a fit of less is no part of the average.
constexpr Severity doubt_of_member(Severity of_fit, double weight) {
  constexpr double small = 0.1, nothing = 1e-6;
  if (of_fit == Severity::error) return weight < small ? Severity::warning : Severity::error;
  return weight < nothing ? Severity::note : of_fit;
}

}  // namespace sysid
