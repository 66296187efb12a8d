// Whole and fraction are kept apart, so that no digit is lost.
#include "data/cell/serial_time.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "core/text/words.hpp"
#include "data/cell/cells.hpp"
#include "data/cell/rounded_times.hpp"

namespace sysid {
namespace {

constexpr std::int64_t second = 1000000000000;
constexpr std::int64_t day = 86400 * second;
constexpr SerialTime serial_times[] = {{"seconds", second, "s"},
                                       {"milliseconds", second / 1000, "ms"},
                                       {"microseconds", second / 1000000, "us"},
                                       {"nanoseconds", second / 1000000000, "ns"},
                                       {"days", day, "d"}};

__extension__ typedef __int128 Wide;

TimeStamp stamp_of(Wide picoseconds) {
  Wide whole = picoseconds / second, rest = picoseconds % second;
  if (rest < 0) rest += second, --whole;
  return {static_cast<std::int64_t>(whole), static_cast<std::int64_t>(rest)};
}

/// `Date`, `datenum`, `start_date`, `StartDate`, and not `update`: a word of the name begins so.
bool is_date_name(std::string_view column) {
  std::string words = " ";
  bool small_before = false;
  for (char const c : column) {
    bool const capital = c >= 'A' && c <= 'Z', small = c >= 'a' && c <= 'z';
    if ((capital && small_before) || !(capital || small)) words += ' ';
    if (capital || small) words += capital ? static_cast<char>(c | 0x20) : c;
    small_before = small;
  }
  for (std::string_view const word : {" date", " datum", " excel", " serial"})
    if (words.find(word) != std::string::npos) return true;
  return false;
}

/// A number as it is written: its digits, and how many of them stand behind the point.
struct Digits {
  std::string digits;
  int decimals = 0;
};

/// Nothing for what is no decimal number without a sign, of a size that fits.
std::optional<Digits> digits_of(std::string_view plain) {
  Digits found;
  bool point = false;
  std::size_t at = 0;
  for (; at < plain.size() && (is_decimal_digit(plain[at]) || (plain[at] == '.' && !point)); ++at) {
    if (plain[at] == '.') {
      point = !found.digits.empty();
      if (!point) return std::nullopt;
    } else {
      found.digits += plain[at];
      found.decimals += point ? 1 : 0;
    }
  }
  if (found.digits.empty()) return std::nullopt;
  if (at == plain.size()) return found;
  if (plain[at] != 'e' && plain[at] != 'E') return std::nullopt;
  constexpr int largest_exponent = 40;
  int exponent = 0;
  char const *begin = plain.data() + at + 1, *const end = plain.data() + plain.size();
  if (begin != end && *begin == '+') ++begin;
  auto const [stop, error] = std::from_chars(begin, end, exponent);
  if (error != std::errc{} || stop != end || exponent > largest_exponent || exponent < -largest_exponent) return std::nullopt;
  found.decimals -= exponent;
  if (found.decimals < 0) found.digits.append(static_cast<std::size_t>(-found.decimals), '0'), found.decimals = 0;
  if (found.decimals >= static_cast<int>(found.digits.size()))
    found.digits.insert(0, static_cast<std::size_t>(found.decimals) + 1 - found.digits.size(), '0');
  return found;
}

/// 10^-decimals days.
double digit_of_days(int decimals) { return 86400 * std::pow(10, -decimals); }

/// Digits behind the point that tell one double of this size from the next.
int decimals_of_double(double size) {
  double const distance = std::nextafter(size, 2 * size + 1) - size;
  return static_cast<int>(std::floor(-std::log10(distance)));
}

/// Days with this many decimals, to the power of ten of a second that is nearest to their last digit: 45356.4173611111 is a minute.
TimeStamp to_round_time(TimeStamp const& stamp, int decimals) {
  Wide last_digit = day, grid = 1;
  for (int i = 0; i < decimals; ++i) last_digit /= 10;
  while (grid < last_digit) grid *= 10;
  Wide const picoseconds = static_cast<Wide>(stamp.second) * second + stamp.picosecond;
  return stamp_of((picoseconds + grid / 2) / grid * grid);
}

/// Equal steps to the last bit.
bool are_even(std::vector<double> const& times) {
  double const last = times.back(), step = last / static_cast<double>(times.size() - 1);
  for (std::size_t i = 0; i < times.size(); ++i)
    if (!(std::fabs(times[i] - static_cast<double>(i) * step) <= 1e-15 * last)) return false;
  return true;
}

/// Of the numbers as they were written, which were the shortest that read back.
int decimals_written(std::vector<double> const& values) {
  int most = 0;
  for (double const value : values) {
    char text[400];
    char const* const end = std::to_chars(text, text + sizeof text, value, std::chars_format::fixed).ptr;
    char const* const point = std::find(static_cast<char const*>(text), end, '.');
    if (point != end) most = std::max(most, static_cast<int>(end - point) - 1);
  }
  return most;
}

/// Whether all steps of days are whole seconds, or tenths to thousandths of one, to within the digits that the numbers have, where
/// so many digits are no chance. Steps that are multiples of 27 ms have an end as decimal numbers of days, as other numbers have.
bool are_steps_of_clocks(std::vector<double> const& days) {
  double const tolerance =
      std::max(digit_of_days(decimals_written(days)), 2 * 86400 * (std::nextafter(days.back(), 2 * days.back()) - days.back()));
  constexpr double share = 0.05;  // of a unit, that chance may hit
  for (double const unit : {1.0, 0.1, 0.01, 0.001}) {
    if (tolerance > share * unit) return false;
    bool whole = true, endless = false;
    for (std::size_t i = 1; i < days.size() && whole; ++i) {
      double const units = (days[i] - days[i - 1]) * 86400 / unit, nearest = std::round(units);
      whole = nearest >= 1 && std::fabs(units - nearest) * unit <= tolerance;
      endless = endless || std::fmod(nearest, 27) != 0;
    }
    if (whole) return endless;
  }
  return false;
}

}  // namespace

SerialTime const* find_serial_time(std::string_view word) {
  auto const found =
      std::find_if(std::begin(serial_times), std::end(serial_times), [&](SerialTime const& each) { return each.word == word; });
  return found == std::end(serial_times) ? nullptr : found;
}

std::optional<SerialStamp> read_serial(std::string_view cell, SerialTime const& unit, NumberNotation const& notation) {
  std::optional<std::string> const plain = in_plain_notation(trimmed(cell, cell_blanks), notation);
  if (!plain) return std::nullopt;
  std::string_view text = *plain;
  bool const negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  auto const read = digits_of(text);
  if (!read) return std::nullopt;
  std::size_t const behind = static_cast<std::size_t>(read->decimals);
  std::string_view whole_digits = std::string_view(read->digits).substr(0, read->digits.size() - behind);
  whole_digits.remove_prefix(std::min(whole_digits.find_first_not_of('0'), whole_digits.size() - 1));
  // Beyond these, whole seconds have more than 64 bits.
  std::size_t const most_digits = unit.picoseconds > second ? 13 : unit.picoseconds < second ? 19 : 18;
  if (whole_digits.size() > most_digits) return std::nullopt;
  Wide whole = 0, fraction = 0, power = 1;
  for (char const c : whole_digits) whole = whole * 10 + (c - '0');
  constexpr std::size_t most_decimals = 18;
  for (char const c : std::string_view(read->digits).substr(read->digits.size() - behind, most_decimals)) {
    fraction = fraction * 10 + (c - '0');
    power *= 10;
  }
  Wide const picoseconds = whole * unit.picoseconds + (fraction * unit.picoseconds + power / 2) / power;
  return SerialStamp{stamp_of(negative ? -picoseconds : picoseconds), static_cast<int>(std::min(behind, most_decimals))};
}

std::optional<SerialStamp> read_duration(std::string_view cell, NumberNotation const& notation) {
  constexpr SerialTime units[] = {{"sec", second, "s"},        {"s", second, "s"},         {"ms", second / 1000, "ms"},
                                  {"min", 60 * second, "min"}, {"hr", 3600 * second, "h"}, {"h", 3600 * second, "h"},
                                  {"days", day, "d"},          {"day", day, "d"}};
  cell = trimmed(cell, cell_blanks);
  std::size_t const blank = cell.find(' ');
  if (blank == std::string_view::npos) return std::nullopt;
  std::string_view const word = trimmed(cell.substr(blank));
  for (SerialTime const& each : units)
    if (each.word == word) return read_serial(cell.substr(0, blank), each, notation);
  return std::nullopt;
}

bool is_stamp_word(std::string_view text) { return text == "iso" || text == duration_word || find_serial_time(text) != nullptr; }

std::vector<double> seconds_of(std::vector<SerialStamp> const& stamps, SerialTime const& unit) {
  std::vector<double> seconds, rounded;
  int decimals = 0;
  for (SerialStamp const& each : stamps) {
    decimals = std::max(decimals, each.decimals);
    seconds.push_back(seconds_between(stamps.front().stamp, each.stamp));
  }
  constexpr int fewest = 6;
  if (unit.picoseconds != day || decimals < fewest) return seconds;
  decimals = std::min(decimals, decimals_of_double(static_cast<double>(stamps.back().stamp.second) / 86400));
  TimeStamp const first = to_round_time(stamps.front().stamp, decimals);
  for (SerialStamp const& each : stamps) rounded.push_back(seconds_between(first, to_round_time(each.stamp, decimals)));
  if (are_even(rounded)) return rounded;
  auto equal = seconds.size() > 2 && std::is_sorted(seconds.begin(), seconds.end())
                   ? equal_times_before_rounding(seconds, digit_of_days(decimals))
                   : std::nullopt;
  return equal ? std::move(*equal) : rounded;
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
  return is_date_name(column) || are_steps_of_clocks(values) ? find_serial_time("days") : nullptr;
}

}  // namespace sysid
