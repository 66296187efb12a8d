// Times of equal steps that a file holds with few digits.
#pragma once
#include <optional>
#include <span>
#include <vector>

namespace sysid {

/// The equal steps that rounded times come from; nothing where no equal steps give them.
///
///   t_i = t_0 + i h,   h = sum of (i - mean i) t_i / sum of (i - mean i)^2, or the one with the least spread of t_i - i h
///
/// What is rounded off lies within half a unit of the last digit of the longest numbers, either way, so that the differences t_i -
/// t_0 - i h lie within one unit of each other. Those of a clock that is off by a unit now and then do not. The step has at least
/// 20 units: of fewer digits, steps that differ look the same. Numbers of single precision were rounded to its last binary digit.
/// time: as the numbers stand in the file, at least two, rising. unit: of their last digit; 0: it is found from them.
std::optional<std::vector<double>> equal_times_before_rounding(std::span<double const> time, double unit = 0);

}  // namespace sysid
