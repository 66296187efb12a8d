// What a calibration found: fits of records that were made from the prior, and where the true values lie in their posteriors.
#pragma once
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "result/finding.hpp"

namespace sysid {

/// Where a true value lies in the posterior of one fit; declared unit.
struct TruePlace {
  double truth = 0, mean = 0, sd = 0;
  double below = 0;  // share of all draws below it
  int rank = 0;      // how many of the thinned draws lie below it, 0 .. their number
};

/// One record made from the prior, and its fit.
struct Replication {
  int number = 0;  // from 0
  std::uint64_t seed = 0;
  int redrawn = 0;                          // prior draws before it that could not be simulated
  std::string failure;                      // why there are no draws; empty: there are
  std::vector<std::string> failed, warned;  // codes of checks of the fit, each once
  double independent = 0;                   // draws: the smallest effective size of a quantity; 0: not known
  std::uint64_t solves = 0;
  bool settled = true;            // the record: a finer solver would not change it
  std::vector<TruePlace> places;  // of each quantity; empty without draws

  bool has_draws() const { return failure.empty(); }
};

/// How ranks differ from uniform ones, by what differs most.
enum class RankShape { uniform, too_narrow, too_wide, too_low, too_high, other };

/// A parameter, or the log likelihood, over all replications with draws.
struct CalibratedQuantity {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

  std::string name, unit;
  std::vector<int> ranks;                                 // one for each of these replications, by rising number
  double covered_50 = 0, covered_90 = 0, covered_95 = 0;  // share of true values inside the central interval
  double mean_z = none, sd_z = none;                      // of (posterior mean - true value) / posterior sd: 0 and 1 expected
  double contraction = none;                              // 1 - mean posterior variance / variance of the true values
  double chi_squared_p = 1, ecdf_p = 1;
  double adjusted_p = 1;  // the smaller of the two, for all that were tested together
  RankShape shape = RankShape::uniform;
};

/// How many fits a check fired in.
struct FiredCheck {
  std::string code;
  int failed = 0, warned = 0;
};

struct CalibrationReport {
  int replications = 0;  // asked for
  int draws = 0;         // that a true value is ranked among
  int bins = 0;          // of the histogram and of chi-square
  std::vector<CalibratedQuantity> quantities;
  std::vector<Replication> records;         // by number
  std::vector<FiredCheck> checks;           // of the fits, most frequent first
  std::vector<double> band_low, band_high;  // of the ECDF minus the uniform one at rank k + 1 of `draws` + 1, all at once 95 %

  int with_draws() const;
  int failed() const { return static_cast<int>(records.size()) - with_draws(); }
};

}  // namespace sysid
