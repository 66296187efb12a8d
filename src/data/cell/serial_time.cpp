// Whole and fraction are kept apart, so that no digit is lost.
#include "data/cell/serial_time.hpp"

#include <algorithm>
#include <cmath>

#include "core/text/words.hpp"
#include "data/cell/cells.hpp"

namespace sysid {
namespace {

constexpr std::int64_t second = 1000000000000;
constexpr std::int64_t day = 86400 * second;
constexpr SerialTime serial_times[] = {{"seconds", second},
                                       {"milliseconds", second / 1000},
                                       {"microseconds", second / 1000000},
                                       {"nanoseconds", second / 1000000000},
                                       {"days", day}};

__extension__ typedef __int128 Wide;

TimeStamp stamp_of(Wide picoseconds) {
  Wide whole = picoseconds / second, rest = picoseconds % second;
  if (rest < 0) rest += second, --whole;
  return {static_cast<std::int64_t>(whole), static_cast<std::int64_t>(rest)};
}

bool is_date_name(std::string_view column) {
  std::string small;
  for (char const c : column) small += c >= 'A' && c <= 'Z' ? static_cast<char>(c | 0x20) : c;
  for (std::string_view const word : {"date", "datum", "excel", "serial"})
    if (small.find(word) != std::string::npos) return true;
  return false;
}

}  // namespace

SerialTime const* find_serial_time(std::string_view word) {
  auto const found =
      std::find_if(std::begin(serial_times), std::end(serial_times), [&](SerialTime const& each) { return each.word == word; });
  return found == std::end(serial_times) ? nullptr : found;
}

std::optional<SerialStamp> read_serial(std::string_view cell, SerialTime const& unit) {
  cell = trimmed(cell, cell_blanks);
  constexpr std::size_t most_digits = 19, most_decimals = 18;
  std::size_t at = 0;
  std::int64_t whole = 0;
  for (; at < cell.size() && is_decimal_digit(cell[at]); ++at) {
    if (at + 1 >= most_digits + (unit.picoseconds < second ? 1 : 0)) return std::nullopt;
    whole = whole * 10 + (cell[at] - '0');
  }
  if (at == 0) return std::nullopt;
  Wide fraction = 0, power = 1;
  int decimals = 0;
  if (at < cell.size() && (cell[at] == '.' || cell[at] == ',')) {
    for (++at; at < cell.size() && is_decimal_digit(cell[at]); ++at) {
      if (static_cast<std::size_t>(decimals) >= most_decimals) continue;
      fraction = fraction * 10 + (cell[at] - '0');
      power *= 10;
      ++decimals;
    }
  }
  if (at != cell.size()) return std::nullopt;
  Wide const picoseconds = static_cast<Wide>(whole) * unit.picoseconds + (fraction * unit.picoseconds + power / 2) / power;
  return SerialStamp{stamp_of(picoseconds), decimals};
}

std::optional<SerialStamp> read_duration(std::string_view cell) {
  constexpr SerialTime units[] = {{"sec", second},       {"s", second},        {"ms", second / 1000}, {"min", 60 * second},
                                  {"hr", 3600 * second}, {"h", 3600 * second}, {"days", day},         {"day", day}};
  cell = trimmed(cell, cell_blanks);
  std::size_t const blank = cell.find(' ');
  if (blank == std::string_view::npos) return std::nullopt;
  std::string_view const word = trimmed(cell.substr(blank));
  for (SerialTime const& each : units)
    if (each.word == word) return read_serial(cell.substr(0, blank), each);
  return std::nullopt;
}

bool is_stamp_word(std::string_view text) { return text == "iso" || text == duration_word || find_serial_time(text) != nullptr; }

TimeStamp without_rounding(TimeStamp const& stamp, SerialTime const& unit, int decimals) {
  constexpr int fewest = 6;
  if (unit.picoseconds != day || decimals < fewest) return stamp;
  Wide last_digit = day, grid = 1;
  for (int i = 0; i < decimals; ++i) last_digit /= 10;
  while (grid < last_digit) grid *= 10;
  Wide const picoseconds = static_cast<Wide>(stamp.second) * second + stamp.picosecond;
  return stamp_of((picoseconds + grid / 2) / grid * grid);
}

SerialTime const* seems_serial(std::vector<double> const& values, std::string_view column) {
  if (values.size() < 2) return nullptr;
  double const first = values.front(), last = values.back();
  auto const within = [&](double from, double to) { return first >= from && last < to && last > first; };
  constexpr double since_1998 = 883612800, since_2100 = 4102444800;
  double scale = 1;
  for (std::string_view const word : {"seconds", "milliseconds", "microseconds", "nanoseconds"}) {
    if (within(since_1998 * scale, since_2100 * scale)) return find_serial_time(word);
    scale *= 1000;
  }
  constexpr double of_1970_in_spreadsheets = 25569, of_1970_in_matlab = 719529, days_to_2100 = 47482;
  if (!within(of_1970_in_spreadsheets, of_1970_in_spreadsheets + days_to_2100) &&
      !within(of_1970_in_matlab, of_1970_in_matlab + days_to_2100))
    return nullptr;
  double const step = (last - first) / static_cast<double>(values.size() - 1), seconds = step * 86400;
  constexpr double decimal_parts = 1e4, nearly = 1e-3;
  bool const short_decimal = std::fabs(step * decimal_parts - std::round(step * decimal_parts)) < nearly;
  bool const whole_seconds = seconds > 0.5 && std::fabs(seconds - std::round(seconds)) < nearly * seconds;
  return is_date_name(column) || (whole_seconds && !short_decimal) ? find_serial_time("days") : nullptr;
}

}  // namespace sysid
