// What the data say of a prior: how much they narrowed it, whether they contradict it, and whether it predicts responses of another
// size than the measured ones.
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "result/finding.hpp"
#include "result/report.hpp"

namespace sysid {

/// Below, a posterior is called hardly narrower than its prior.
inline constexpr double hardly_narrower = 1.5;

/// By how much narrower the posterior's 90 % interval is than the prior's; nothing where either is not known.
std::optional<double> contraction(PriorInfo const& prior, Summary const& summary);

/// The posterior's 90 % interval; of an optimum that of its normal approximation.
std::pair<double, double> interval_90(Summary const& summary);

/// Parameters whose posterior lies where their prior has next to nothing.
Findings check_priors(Report const& report);

/// Further apart than this many times: a wrong unit or a wild prior. Medians of the shipped models lie within a factor of 5.2 of
/// what was measured, so that a unit a thousand times too large or small shows in each of them, by 190 and more.
inline constexpr double wild = 100;
/// The share of failed draws that deserves a warning.
inline constexpr double many_failures = 0.2;

/// "120 times larger" of a ratio of 120, "120 times smaller" of its inverse.
std::string times_apart(double ratio);

/// prior_far_from_data with what was found.
Finding prior_far_from_data(std::vector<std::string> names, std::string message);

}  // namespace sysid
