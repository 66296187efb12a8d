// How much the data narrowed a parameter: its posterior against its prior.
#pragma once
#include <optional>
#include <utility>

#include "result/report.hpp"

namespace sysid {

/// Below, a posterior is called hardly narrower than its prior.
inline constexpr double hardly_narrower = 1.5;

/// By how much narrower the posterior's 90 % interval is than the prior's; nothing where either is not known.
std::optional<double> contraction(PriorInfo const& prior, Summary const& summary);

/// The posterior's 90 % interval; of an optimum that of its normal approximation.
std::pair<double, double> interval_90(Summary const& summary);

}  // namespace sysid
