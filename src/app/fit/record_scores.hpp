// The log densities of the scored samples of one record under some draws, and what leaving parts of it out changes.
#pragma once
#include "app/fit/fit_checks.hpp"
#include "criteria/scores.hpp"

namespace sysid {

inline constexpr int blocks_of_record = 10;                                        // that are left out one by one
inline constexpr double most_densities = (std::size_t{1} << 27) / sizeof(double);  // that are held at once

/// Some of the draws, chain after chain, all chains of one length.
struct SomeDraws {
  LaneArray columns;  // [parameters x draws]
  int chains;
};

struct ScoredRecord {
  bool ended = false;       // false: a draw has no solution, or the user has interrupted
  int failed = 0;           // draws without a solution
  double own_variance = 0;  // of the Monte Carlo error of what is predicted by draws of its own
};

/// What the earlier posteriors of a record may cost.
struct OwnDraws {
  int round;    // draws of each round
  int walkers;  // that reach for the ends of a ridge; 0: none
};

/// Adds a series for each channel of an experiment, and of a record in time its blocks, to `criteria`; the influences [draws] count
/// on over all records.
ScoredRecord score_record(FinishedFit& fit, Criteria& criteria, int experiment, SomeDraws const& draws, OwnDraws own,
                          DrawInfluence& loo, DrawInfluence& block, DrawInfluence& future);

}  // namespace sysid
