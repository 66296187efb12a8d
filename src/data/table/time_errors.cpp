#include "data/table/time_errors.hpp"

#include <fmt/format.h>

#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "data/cell/serial_time.hpp"
#include "data/cell/time_stamp.hpp"
#include "data/cell/unit_text.hpp"
#include "data/table/reading_rules.hpp"

namespace sysid::data_errors {

Diagnostic stamp_among_numbers(Cell const& cell, std::string_view text, Mention mention) {
  return error(
      "E4010", mention, fmt::format("{}: `{}` is not a number", place(cell), shown(text)),
      "the cells above it are numbers: correct this cell (write a time in the unit of the column, such as seconds) or delete the "
      "line");
}

Diagnostic durations(Cell const& cell, std::string_view text, Mention mention) {
  return error("E4010", mention, fmt::format("{}: `{}` is a number with its unit", place(cell), shown(text)),
               "add this line to the data block: `read stamp = duration`");
}

Diagnostic times_are_dates(Cell const& cell, double value, std::string_view word, bool is_text, Mention mention) {
  std::string help =
      fmt::format("add this line to the data block: `read stamp = {}`; times then begin with 0 at the first row", word);
  if (!is_text)
    help = fmt::format("write their unit in the data block: `time {}`", column_text(cell.column, find_serial_time(word)->unit));
  if (word == "days") help += fmt::format("; if they are seconds, `time {}`", column_text(cell.column, "s"));
  return error(
      "E4029", mention,
      fmt::format("{}: {:.15g} is probably not a time in seconds from the start of the record, but {} since {}", place(cell), value,
                  word, word == "days" ? "1900 or the year 0, as spreadsheets and MATLAB count them" : "1970"),
      std::move(help));
}

Diagnostic times_are_clock(Cell const& cell, double before, double now, std::vector<std::string> const& patterns, bool is_text,
                           Mention mention) {
  std::vector<std::string> lines, digits;
  for (std::string const& pattern : patterns) {
    lines.push_back(fmt::format("read stamp = \"{}\"", pattern));
    digits.push_back(pattern.substr(0, pattern.find_first_of(".,")));
  }
  lines.emplace_back("read stamp = seconds");
  std::string const help =
      is_text ? fmt::format("add one of these lines to the data block: {}; the last one if the numbers are seconds",
                            quoted(lines, "or"))
              : "save them as seconds: `read stamp` is not possible for this kind of file";
  return error("E4029", mention,
               fmt::format("{}: {:.15g} after {:.15g} looks like a time of day written in digits, {}, and not like seconds",
                           place(cell), now, before, quoted(digits, "or")),
               help);
}

Diagnostic times_are_counts(Cell const& cell, Mention mention) {
  return error("E4029", mention,
               fmt::format("column `{}` of `{}` counts the rows and has no unit, so it is not read as a time", shown(cell.column),
                           cell.file),
               "write `rate` or `step` in place of `time` in the data block; if it counts seconds, write `[s]` after the column");
}

Diagnostic zones_differ(Cell const& cell, std::string_view text, bool has_zone, Mention mention) {
  return error("E4024", mention,
               fmt::format("{}: `{}` has {} zone, and the first row has {}", place(cell), shown(text), has_zone ? "a" : "no",
                           has_zone ? "none" : "one"),
               "write the zone in all rows, or in none: no zone is assumed for times without one");
}

Diagnostic fractions_differ(Cell const& cell, std::string_view text, Mention mention) {
  return error("E4024", mention,
               fmt::format("{}: `{}` has more or fewer digits after its last colon than the first row, so they are not a "
                           "fraction of a second",
                           place(cell), shown(text)),
               "write the time in seconds, or give `rate` in place of the time column");
}

Diagnostic not_a_stamp(Cell const& cell, std::string_view text, std::string const& pattern, Mention mention) {
  bool const is_count = find_serial_time(pattern) != nullptr;
  std::string const what = text.empty() ? "the cell is not" : fmt::format("`{}` is not", shown(text));
  return error(
      "E4024", mention,
      fmt::format("{}: {} a time as in `stamp = {}`", place(cell), what, is_stamp_word(pattern) ? pattern : "\"" + pattern + "\""),
      is_count
          ? fmt::format("with `stamp = {}` every cell is a number in the notation of the file: `1714500000` or `45356.25`", pattern)
          : "YYYY, MM, DD stand for a date, hh, mm, ss, f for the time and the digits of its fraction, AP for AM or PM");
}

Diagnostic time_not_increasing(Cell const& cell, double before, double now, std::string const& unit, Mention mention) {
  return error("E4014", mention,
               fmt::format("{}: time does not increase, {}{} comes after {}{}", place(cell), now, unit_after_number(unit), before,
                           unit_after_number(unit)),
               now == before ? "if the row repeats the one before it, remove it; if the sampling was regular and the times were "
                               "rounded, write `rate` or `step` in place of `time`"
                             : "sort the rows and remove repeated ones; if the file contains two runs, divide it into two files");
}

Diagnostic unequal_steps(int row, double step, double usual, Mention mention) {
  return error(
      "E4015", mention,
      fmt::format("`band_limited` needs equal time steps, but row {} is {:.9g} s after the row before; the mean step is {:.9g} s",
                  row, step, usual),
      "if the sampling was regular and the printed times are rounded, give `rate` instead of the time column; otherwise use "
      "`cubic` or `linear`");
}

}  // namespace sysid::data_errors
