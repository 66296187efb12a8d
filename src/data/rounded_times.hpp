// Times of equal steps that a file holds with few digits.
#pragma once
#include <optional>
#include <span>
#include <vector>

namespace sysid {

/// The equal steps that rounded times come from; nothing where no equal steps give them.
///
///   t_i = t_0 + i h,   h = sum of i (t_i - t_0) / sum of i^2,   each within one unit of the last digit of the longest numbers
///
/// Two times are rounded, the first one as well, by half a unit each. The step has at least 20 units: of fewer digits, steps that
/// differ look the same. time: as the numbers stand in the file, at least two, rising.
std::optional<std::vector<double>> equal_times_before_rounding(std::span<double const> time);

}  // namespace sysid
