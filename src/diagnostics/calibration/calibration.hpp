// Simulation-based calibration from the places of true values in their posteriors: ranks, coverage, and what is wrong.
#pragma once
#include <string>
#include <vector>

#include "result/calibration.hpp"

namespace sysid {

/// One of `quantities` by name and unit.
struct QuantityName {
  std::string name, unit;
  bool parameter = true;  // has a prior, which data narrow
};

/// Tests all quantities over the replications that have draws. replications: how many were asked for; draws: that values are ranked
/// among, such that draws + 1 has a divisor up to 20.
///
/// p values are those of Säilynoja et al. (2022) and of chi-square; the smaller one times the number of tests (Bonferroni).
CalibrationReport calibration_of(std::vector<QuantityName> const& quantities, std::vector<Replication> records, int replications,
                                 int draws);

/// What is wrong with it: ranks that are not uniform, and replications that cannot say.
Findings calibration_findings(CalibrationReport const& calibration);

/// Of the smallest adjusted p value.
inline constexpr double doubtful_p = 0.01, wrong_p = 0.001;

/// The sd of a share among n.
double share_error(double share, int n);

/// "posteriors too narrow: true values lie in their tails too often".
std::string_view shape_words(RankShape shape);

}  // namespace sysid
