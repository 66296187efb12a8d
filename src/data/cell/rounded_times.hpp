// Whether the steps of times are equal, as they stand or before they were written with few digits.
#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace sysid {

/// [s] time: [N], N >= 2.
double mean_step(std::span<double const> time);
/// The first sample whose step from the one before differs from the mean by more than a part in a million; 0: none.
std::size_t unequal_step(std::span<double const> time, double tolerance = 1e-6);

/// The equal steps that rounded times come from; nothing where no equal steps give them.
///
///   t_i = t_0 + i h,   h = sum of (i - mean i) t_i / sum of (i - mean i)^2, or the one with the least spread of t_i - i h
///
/// What is rounded off lies within half a unit of the last digit of the longest numbers, either way, so that the differences t_i -
/// t_0 - i h lie within one unit of each other. Those of a clock that is off by a unit now and then do not. The step has at least
/// 20 units: of fewer digits, steps that differ look the same. Numbers of single precision were rounded to its last binary digit.
/// time: as the numbers stand in the file, at least two, rising. unit: of their last digit; 0: it is found from them.
std::optional<std::vector<double>> equal_times_before_rounding(std::span<double const> time, double unit = 0);

/// Whether steps are equal, as the numbers stand or before they were rounded.
bool has_equal_steps(std::span<double const> time);

/// The unit of the last digit of these numbers, as they stand in the file.
double last_digit(std::span<double const> time);

/// Times that equal steps give when they are rounded to few units.
struct RoundedSteps {
  double unit = 0;   // s, of the last digit
  double lower = 0;  // s, of the two steps that are there, one unit apart
  double rate = 0;   // Hz, of the equal steps: the number of fewest digits that gives these times
};

/// For steps of one and a half units or more. Within one unit of equal steps stay fewer than n^3 of the 2^n ways to put n steps of
/// two neighbouring whole numbers of units in order; here are 40 steps at least, and five of both. So it is no chance, but these
/// times may also be right as they are: a recorder that waits for equal times and samples at the next tick of its clock gives the
/// same. That no number tells. scale: s that 1 of these times is.
std::optional<RoundedSteps> rounded_steps(std::span<double const> time, double scale);

}  // namespace sysid
