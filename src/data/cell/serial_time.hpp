// Times that are dates as plain numbers: seconds since 1970, days as spreadsheets count them.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "data/cell/number_notation.hpp"
#include "data/cell/time_stamp.hpp"

namespace sysid {

/// What `stamp` says where the cells are numbers: `seconds`, `milliseconds`, `microseconds`, `nanoseconds`, `days`.
struct SerialTime {
  std::string_view word;
  std::int64_t picoseconds;  // that one of them has
  std::string_view unit;     // of the language
};
SerialTime const* find_serial_time(std::string_view word);

/// The cell as a count of these, exactly: doubles have 0.2 us of the seconds since 1970. Nothing for what is no number in this
/// notation, and for more whole digits than 13 of days, 18 of seconds, 19 of their parts.
struct SerialStamp {
  TimeStamp stamp;
  int decimals = 0;  // that were written
};
std::optional<SerialStamp> read_serial(std::string_view cell, SerialTime const& unit, NumberNotation const& notation = {});
/// What `stamp` says of durations as MATLAB writes them, `0.01 sec`, `1.5 min`, `2 hr`, `3 days`.
constexpr std::string_view duration_word = "duration";
/// One of them, exactly; nothing for any other text.
std::optional<SerialStamp> read_duration(std::string_view cell, NumberNotation const& notation = {});

/// Whether it is no pattern but a word: `iso`, `duration`, or that of a SerialTime.
bool is_stamp_word(std::string_view text);

/// [s] since the first of them, of which there is one. Days with six decimals and more have been rounded: where times of whole
/// powers of ten of a second give equal steps, it is these, else the equal steps that give the decimals, else such times.
std::vector<double> seconds_of(std::vector<SerialStamp> const& stamps, SerialTime const& unit);

/// What numbers that are taken for seconds seem to count in truth, by their size and their steps: seconds and their parts since
/// 1970, of the years 1998 to 2099; days since 1900 (spreadsheets) or since the year 0 (MATLAB), of 1970 to 2099, where `column` is
/// called after a date or each step is a whole number of seconds, or of their tenths to thousandths, and no short decimal of a day.
/// Null where they seem to be what they are taken for.
SerialTime const* seems_serial(std::vector<double> const& values, std::string_view column);

}  // namespace sysid
