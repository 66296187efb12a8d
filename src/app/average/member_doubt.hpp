// Findings about one fit of an average, or about its trajectories; their severity depends on the weight of the fit.
#pragma once
#include "app/average/mixture_bands.hpp"
#include "core/text/diagnostic.hpp"

namespace sysid {

inline constexpr double small_weight = 0.1;

/// Of what is wrong with its trajectories.
constexpr Severity doubt_of_trajectories(Severity alone, double weight) {
  if (weight < negligible_weight) return Severity::note;
  if (weight >= small_weight) return alone;
  return alone == Severity::error ? Severity::warning : Severity::note;
}

/// The severity of `from_doubtful_fit` of a member with this weight. By a failed fit a weight may be small that should not be: it
/// stays a warning. What only warns makes no weight smaller by a million: a fit of less is no part of the average.
constexpr Severity doubt_of_member(Severity of_fit, double weight) {
  constexpr double nothing = 1e-6;
  if (of_fit == Severity::error) return weight < small_weight ? Severity::warning : Severity::error;
  return weight < nothing ? Severity::note : of_fit;
}

}  // namespace sysid
