// The last digit follows from the shortest decimal that reads back as the number.
#include "data/rounded_times.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace sysid {
namespace {

constexpr double least_units = 20;  // of a step
constexpr double tolerance = 1.01;  // units of the last digit: beside both halves the error of h

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
  return std::max(std::pow(10, -decimals), std::pow(10, exponent + 1 - digits));
}

}  // namespace

std::optional<std::vector<double>> equal_times_before_rounding(std::span<double const> time) {
  double sum = 0, squares = 0;
  for (std::size_t i = 1; i < time.size(); ++i) {
    double const n = static_cast<double>(i);
    sum += n * (time[i] - time[0]);
    squares += n * n;
  }
  double const step = sum / squares, unit = last_unit(time);
  if (!(step >= least_units * unit)) return std::nullopt;
  std::vector<double> equal(time.size());
  for (std::size_t i = 0; i < time.size(); ++i) {
    equal[i] = time[0] + static_cast<double>(i) * step;
    if (!(std::fabs(time[i] - equal[i]) <= tolerance * unit)) return std::nullopt;
  }
  return equal;
}

}  // namespace sysid
