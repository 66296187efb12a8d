// Is the likelihood of a filter that describes random states by mean and covariance the right one? Independent estimates, as those
// of particles, say how far it is off at some places.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "model/filter_rule.hpp"
#include "result/finding.hpp"

namespace sysid {

/// What unbiased estimates of the likelihood at one place say of its filter [nats].
struct FilterOffset {
  double value = 0;    // log of their mean, less the log likelihood of the filter
  double error = 0;    // standard error of it
  double sd = 0;       // of the log of one estimate
  bool known = false;  // whether the error is small, and can be believed
  /// Within these limits the offset is. However much estimates scatter, their mean hardly ever exceeds the likelihood by a large
  /// factor (Markov's inequality). Upwards, those that scatter hide far more, as the few that are large may be missing.
  double least() const;
  double most() const;
};

/// estimates: their logarithms. filter: its own log likelihood.
FilterOffset filter_offset(std::span<double const> estimates, double filter);

/// Of one filter, over several places.
struct FilterComparison {
  std::vector<FilterOffset> offsets;
  int worst = -1;     // the place where it is clearly off by more than evidences may be; -1: none
  double change = 0;  // of the offset from one place to another, at least so much, if that clearly changes the posterior; else 0

  bool holds() const { return worst < 0 && change == 0; }
  /// Whether enough offsets are known to say that it holds.
  bool known() const;
};
FilterComparison compare_filter(std::vector<FilterOffset> offsets);
/// Whether two sets of estimates show the same offsets, within their errors.
bool same_offsets(FilterComparison const& a, FilterComparison const& b);

/// How places are called.
struct ComparedPlaces {
  std::string one;   // "draw"
  std::string rows;  // ", on the first 300 rows of the record"; empty: on all
};
/// own: does not hold. unscented: of that filter at the same places, if `filter` is another; else null.
Finding filter_finding(FilterComparison const& own, FilterRule filter, FilterComparison const* unscented,
                       ComparedPlaces const& places);

}  // namespace sysid
