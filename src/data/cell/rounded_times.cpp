// The last digit follows from the shortest decimal that reads back as the number, or is binary.
#include "data/cell/rounded_times.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace sysid {
namespace {

constexpr double least_units = 20;  // of a step
constexpr double tolerance = 1.05;  // units of the last digit: half of one either way, and the error of h

struct Decimal {
  int digits = 1;    // significant ones
  int exponent = 0;  // of the first
};

Decimal shortest(double value) {
  char text[40];
  auto const end = std::to_chars(text, text + sizeof text, std::fabs(value), std::chars_format::scientific).ptr;
  char const* const e = std::find(text, end, 'e');
  Decimal decimal;
  decimal.digits = static_cast<int>(e - text) - (e - text > 1 ? 1 : 0);
  std::from_chars(e + (e[1] == '+' ? 2 : 1), end, decimal.exponent);
  return decimal;
}

/// Whether all numbers are of single precision, written out in full or with the nine digits that such a number needs.
bool of_single_precision(std::span<double const> time) {
  constexpr int enough = 9;
  return std::all_of(time.begin(), time.end(), [](double each) {
    double const off = std::fabs(each - static_cast<double>(static_cast<float>(each)));
    if (off == 0) return true;
    Decimal const decimal = shortest(each);
    return decimal.digits <= enough && off <= 0.501 * std::pow(10, decimal.exponent + 1 - enough);
  });
}

/// The distance of the next number of single precision from the largest one.
double single_unit(std::span<double const> time) {
  double largest = 0;
  for (double const each : time) largest = std::max(largest, std::fabs(each));
  auto const single = static_cast<float>(largest);
  return static_cast<double>(std::nextafter(single, std::numeric_limits<float>::infinity())) - static_cast<double>(single);
}

/// The largest unit of the last digit. Zeros at the end are not written by all programs, so the longest number shows how many
/// digits there are: as many significant ones, or as many behind the point.
double last_unit(std::span<double const> time) {
  int digits = 1, decimals = std::numeric_limits<int>::min(), exponent = std::numeric_limits<int>::min();
  for (double const each : time) {
    if (each == 0) continue;
    Decimal const decimal = shortest(each);
    digits = std::max(digits, decimal.digits);
    decimals = std::max(decimals, decimal.digits - 1 - decimal.exponent);
    exponent = std::max(exponent, decimal.exponent);
  }
  double const unit = std::max(std::pow(10, -decimals), std::pow(10, exponent + 1 - digits));
  return of_single_precision(time) ? std::max(unit, single_unit(time)) : unit;
}

/// Of t_i - i h.
double spread(std::span<double const> time, double step) {
  double least = 0, most = 0;
  for (std::size_t i = 0; i < time.size(); ++i) {
    double const off = time[i] - time[0] - static_cast<double>(i) * step;
    least = std::min(least, off);
    most = std::max(most, off);
  }
  return most - least;
}

/// Near a step: a spread is a convex function of it. Where rounding errors grow along half of the record, as those of steps that
/// are nearly whole units do, least squares take them for a part of the step.
double of_least_spread(std::span<double const> time, double step, double unit) {
  constexpr int thirds = 60;
  double const about = 3 * unit / static_cast<double>(time.size() - 1);
  double low = step - about, high = step + about;
  for (int round = 0; round < thirds; ++round) {
    double const left = low + (high - low) / 3, right = high - (high - low) / 3;
    if (spread(time, left) < spread(time, right))
      high = right;
    else
      low = left;
  }
  return (low + high) / 2;
}

/// The outermost step on one side of `step` that has no larger spread than `allowed`.
double outermost(std::span<double const> time, double step, double far, double allowed) {
  constexpr int halvings = 60;
  for (int round = 0; round < halvings; ++round) {
    double const middle = (step + far) / 2;
    (spread(time, middle) <= allowed ? step : far) = middle;
  }
  return step;
}

/// Whether there are two neighbouring whole numbers of units and no other step.
bool of_two_steps(std::span<double const> time, double unit) {
  constexpr std::size_t fewest = 5;
  double const low = std::floor((time.back() - time.front()) / static_cast<double>(time.size() - 1) / unit);
  std::size_t lower = 0, upper = 0;
  for (std::size_t i = 1; i < time.size(); ++i) {
    double const steps = (time[i] - time[i - 1]) / unit, whole = std::round(steps);
    if (std::fabs(steps - whole) > 0.01) return false;
    if (whole != low && whole != low + 1) return false;
    ++(whole == low ? lower : upper);
  }
  return lower >= fewest && upper >= fewest;
}

/// The number of fewest digits.
double shortest_between(double least, double most) {
  double const middle = (least + most) / 2;
  constexpr int all_digits = 17;
  for (int digits = 1; digits < all_digits; ++digits) {
    char text[40];
    auto const end = std::to_chars(text, text + sizeof text, middle, std::chars_format::scientific, digits - 1).ptr;
    double number = middle;
    std::from_chars(text, end, number);
    if (number >= least && number <= most) return number;
  }
  return middle;
}

}  // namespace

double last_digit(std::span<double const> time) { return last_unit(time); }

std::optional<RoundedSteps> rounded_steps(std::span<double const> time, double scale) {
  constexpr std::size_t fewest_steps = 40;
  constexpr double fewest_units = 1.5;
  if (time.size() <= fewest_steps) return std::nullopt;
  double const unit = last_unit(time), rough = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  if (!(rough >= fewest_units * unit) || !of_two_steps(time, unit)) return std::nullopt;
  double const step = of_least_spread(time, rough, unit), least_spread = spread(time, step);
  if (!(least_spread <= tolerance * unit)) return std::nullopt;
  double const allowed = std::max(unit, least_spread) * (1 + 1e-9), about = 3 * unit / static_cast<double>(time.size() - 1);
  double const least = outermost(time, step, step - about, allowed), most = outermost(time, step, step + about, allowed);
  return RoundedSteps{unit * scale, std::floor(rough / unit) * unit * scale,
                      shortest_between(1 / (most * scale), 1 / (least * scale))};
}

double mean_step(std::span<double const> time) { return (time.back() - time.front()) / static_cast<double>(time.size() - 1); }

std::size_t unequal_step(std::span<double const> time, double part) {
  double const usual = mean_step(time);
  for (std::size_t i = 1; i < time.size(); ++i)
    if (!(std::fabs(time[i] - time[i - 1] - usual) <= part * usual)) return i;
  return 0;
}

bool has_equal_steps(std::span<double const> time) {
  return unequal_step(time) == 0 || equal_times_before_rounding(time).has_value();
}

std::optional<std::vector<double>> equal_times_before_rounding(std::span<double const> time, double unit) {
  double const middle = static_cast<double>(time.size() - 1) / 2;
  if (unit == 0) unit = last_unit(time);
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < time.size(); ++i) {
    double const n = static_cast<double>(i) - middle;
    sum += n * (time[i] - time[0]);
    squares += n * n;
  }
  double step = sum / squares;
  if (!(step >= least_units * unit)) return std::nullopt;
  if (!(spread(time, step) <= tolerance * unit)) step = of_least_spread(time, step, unit);
  if (!(spread(time, step) <= tolerance * unit)) return std::nullopt;
  std::vector<double> equal(time.size());
  for (std::size_t i = 0; i < time.size(); ++i) equal[i] = time[0] + static_cast<double>(i) * step;
  return equal;
}

}  // namespace sysid
