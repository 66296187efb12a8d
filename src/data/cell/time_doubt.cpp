// The same steps, counted in two ways: the one in which they are alike is meant.
#include "data/cell/time_doubt.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace sysid {
namespace {

/// A time of day in digits: of hours and minutes, and of seconds in `hhmmss`.
struct ClockDigits {
  std::string_view pattern;
  double hour, end;  // of the number: one hour more, one day
  double unit;       // [s] of the last place
  bool whole;
};
constexpr ClockDigits clock_digits[] = {{"hhmmss.f", 10000, 240000, 1, false}, {"hhmm", 100, 2400, 60, true}};

/// [s] since midnight.
std::optional<double> of_day(double value, ClockDigits const& digits) {
  if (!(value >= 0) || value > digits.end || (digits.whole && value != std::floor(value))) return std::nullopt;
  double const hours = std::floor(value / digits.hour), rest = value - hours * digits.hour;
  if (digits.whole) return rest < 60 ? std::optional(hours * 3600 + rest * 60) : std::nullopt;
  double const minutes = std::floor(rest / 100), seconds = rest - minutes * 100;
  return minutes < 60 && seconds < 60 ? std::optional(hours * 3600 + minutes * 60 + seconds) : std::nullopt;
}

struct Steps {
  std::vector<double> number, clock;
};
/// Empty where a number is no time of day, or one does not come after the other.
Steps steps_of(std::vector<double> const& values, ClockDigits const& digits) {
  constexpr double day = 86400;
  Steps steps;
  std::optional<double> before;
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::optional<double> const now = of_day(values[i], digits);
    if (!now) return {};
    if (before) {
      double const step = *now - *before;
      steps.clock.push_back(step < -day / 2 ? step + day : step);
      steps.number.push_back(values[i] - values[i - 1]);
      if (!(steps.clock.back() > 0)) return {};
    }
    before = now;
  }
  return steps;
}

/// The step that jumps as a number among those that are alike as times of day; 0: none.
std::size_t jump_in(Steps const& steps) {
  constexpr double near = 0.5, share = 0.75;
  std::vector<double> sorted = steps.clock;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  double const median = sorted[sorted.size() / 2];
  double least = std::numeric_limits<double>::infinity(), most = 0, least_number = least, most_number = 0;
  std::size_t alike = 0, place = 0;
  for (std::size_t i = 0; i < steps.clock.size(); ++i) {
    if (std::fabs(steps.clock[i] - median) > near * median) continue;
    ++alike;
    least = std::min(least, steps.clock[i]);
    most = std::max(most, steps.clock[i]);
    double const number = steps.number[i] > 0 ? steps.number[i] : std::numeric_limits<double>::infinity();  // past midnight
    least_number = std::min(least_number, number);
    if (number > most_number) most_number = number, place = i + 1;
  }
  bool const regular = static_cast<double>(alike) >= share * static_cast<double>(steps.clock.size());
  // A few numbers of seconds with steps of a minute or so may have no 60 to 99 in them by chance, but hardly alike steps as well.
  constexpr std::size_t few = 12;
  constexpr double equal = 1.02, apart = 1.2, far_apart = 3;
  double const times = steps.clock.size() < few && most > equal * least ? far_apart : apart;
  return regular && most_number > times * least_number * most / least ? place : 0;
}

bool rises_by_hundreds(std::vector<double> const& values, Steps const& steps) {
  constexpr double first = 10000, minute = 100;
  return values.front() >= first && std::all_of(steps.number.begin(), steps.number.end(),
                                                [](double step) { return step > 0 && std::fmod(step, minute) == 0; });
}

}  // namespace

ClockDoubt seems_clock(std::vector<double> const& values, bool even_steps) {
  ClockDoubt doubt;
  if (values.size() < 3) return doubt;
  for (ClockDigits const& digits : clock_digits) {
    Steps const steps = steps_of(values, digits);
    if (steps.clock.empty()) continue;
    std::size_t place = jump_in(steps);
    if (place == 0 && even_steps && !digits.whole && rises_by_hundreds(values, steps)) place = 1;
    if (place == 0) continue;
    doubt.patterns.emplace_back(digits.pattern);
    doubt.place = place;
  }
  return doubt;
}

bool counts_rows(std::vector<double> const& values, std::string_view column) {
  std::string name;
  for (char const c : column)
    if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z')) name += static_cast<char>(c | 0x20);
  constexpr std::string_view names[] = {
      "record",   "recordno",     "recordnumber", "recno",  "recnum",     "recnbr",     "rn",    "sample",   "samples",
      "sampleno", "samplenumber", "sampleindex",  "scan",   "scanno",     "scannumber", "index", "idx",      "row",
      "rowno",    "rownumber",    "stepnum",      "stepno", "stepnumber", "step",       "lfdnr", "messpunkt"};
  if (values.size() < 3 || std::find(std::begin(names), std::end(names), name) == std::end(names)) return false;
  if (values.front() != std::floor(values.front())) return false;
  for (std::size_t i = 1; i < values.size(); ++i)
    if (values[i] - values[i - 1] != 1) return false;
  return true;
}

}  // namespace sysid
