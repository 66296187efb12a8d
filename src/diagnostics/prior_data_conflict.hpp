// Priors that predict responses of another size than the measured ones.
#pragma once
#include <string>

#include "result/finding.hpp"

namespace sysid {

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
