// The wording of data errors. Messages are lower case without a full stop; `help` states what to do.
#include "data/table/file_errors.hpp"

#include <fmt/format.h>

#include <cmath>

#include <algorithm>

#include "core/text/utf8.hpp"
#include "core/text/words.hpp"
#include "data/cell/cells.hpp"
#include "data/cell/serial_time.hpp"
#include "data/cell/time_stamp.hpp"
#include "data/cell/unit_text.hpp"
#include "data/table/reading_rules.hpp"

namespace sysid::data_errors {
namespace {

Diagnostic error(std::string code, Mention mention, std::string message, std::string help) {
  Diagnostic result{Severity::error, std::move(code), std::move(message), {}, {}, std::move(help)};
  if (mention) result.primary = Label{*mention, {}};
  return result;
}

std::string place(std::string const& file, int row, int line) {
  return line > 0 ? fmt::format("`{}` row {} (line {})", file, row, line) : fmt::format("`{}` row {}", file, row);
}

std::string place(Cell const& cell) { return fmt::format("{}, column `{}`", place(cell.file, cell.row, cell.line), cell.column); }

/// A cell may hold anything: shown without control characters and not at any length.
std::string shown(std::string_view text) {
  constexpr std::size_t longest = 40;
  std::string result;
  for (char const c : text.substr(0, character_begin(text, longest)))
    result += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  return text.size() > longest ? result + "..." : result;
}

std::string column_names(std::vector<std::string> const& names) {
  std::vector<std::string> marked;
  for (std::string const& name : names) marked.push_back(fmt::format("`{}`", shown(name)));
  return first_listed(marked, 20);
}

/// What stands there as a unit of the language, where it is one; else empty. A model of unknown origin may name any file as data,
/// so what is no unit is not repeated.
std::string as_unit(std::string_view text) {
  auto const unit = unit_of_text(text);
  return unit ? unit->text : std::string();
}

/// `1,234.5`, `1.234,5`, `1'234`: a number whose digits stand in groups of three, as it is to be written; else empty.
std::string without_groups(std::string_view text) {
  if (text.size() >= 2 && text.front() == '"') text = text.substr(1, text.size() - 2);
  std::string out;
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) {
    if (text.front() == '-') out += '-';
    text.remove_prefix(1);
  }
  std::size_t const first = text.find_first_not_of("0123456789");
  if (first == 0 || first > 3 || first == std::string_view::npos ||
      std::string_view(",.' ").find(text[first]) == std::string_view::npos)
    return {};
  out += text.substr(0, first);
  std::size_t at = first;
  int groups = 0;
  for (; at < text.size() && text[at] == text[first]; at += 4, ++groups) {
    for (std::size_t i = at + 1; i <= at + 3; ++i)
      if (i >= text.size() || !is_decimal_digit(text[i])) return {};
    out += text.substr(at + 1, 3);
  }
  if (at < text.size() && (text[at] == '.' || text[at] == ',')) {
    out += '.';
    ++at;
  } else if (groups == 1 && text[first] == '.') {
    return {};
  }
  if (text.substr(std::min(at, text.size())).find_first_not_of("0123456789eE+-") != std::string_view::npos) return {};
  return out + std::string(text.substr(std::min(at, text.size())));
}

}  // namespace

Diagnostic no_header(std::string const& file, Mention mention) {
  return error("E4001", mention, fmt::format("`{}` is empty", file),
               "the first line must name the columns, for example `t,force,y`");
}

Diagnostic header_of_numbers(std::string const& file, int line, bool after_comment, Mention mention) {
  return error("E4002", mention, fmt::format("line {} of `{}` should name the columns but begins with a number", line, file),
               after_comment ? "lines that begin with `#` are comments: name the columns on a line without `#`"
                             : "put a line with the names of the columns above the numbers");
}

Diagnostic not_text(std::string const& file, std::optional<std::string> const& proposed, Mention mention) {
  return error("E4003", mention, fmt::format("`{}` is not UTF-8 text", file),
               proposed ? *proposed : "records are text, MATLAB files (.mat), NetCDF and HDF5; save a spreadsheet as CSV");
}

Diagnostic not_in_encoding(std::string const& file, std::string const& encoding, Mention mention) {
  return error("E4003", mention, fmt::format("`{}` is not text in {}", file, encoding),
               "remove `encoding` from the data block where the file is in UTF-8");
}

namespace {

std::string columns_there_are(std::vector<std::string> const& known) {
  return known.empty() ? "it has no vectors of numbers" : fmt::format("its vectors of numbers are {}", column_names(known));
}

}  // namespace

Diagnostic missing_variable(std::string const& file, std::string const& variable, std::vector<std::string> const& known,
                            Mention mention) {
  std::string const guess = did_you_mean(variable, known);
  return error("E4008", mention, fmt::format("`{}` has no variable `{}`", file, variable),
               guess + (guess.empty() ? "" : " ") + columns_there_are(known));
}

Diagnostic no_column_of_numbers(std::string const& file, std::string const& variable, std::string const& reason,
                                std::vector<std::string> const& known, Mention mention) {
  return error("E4027", mention, fmt::format("`{}` of `{}` {}", shown(variable), file, reason), columns_there_are(known));
}

Diagnostic not_a_record(std::string const& file, std::string_view what, std::string_view help, Mention mention) {
  return error("E4003", mention, fmt::format("`{}` is {}, which is not read", file, what), std::string(help));
}

Diagnostic reading_of_no_text(std::string const& file, std::string_view what, Mention mention) {
  return error("E4025", mention, fmt::format("`{}` is a {}, for which `missing` is the only setting of `read`", file, what),
               "remove `read` from the data block, or all its settings except `missing`");
}

Diagnostic word_among_numbers(std::string const& file, std::string_view what, std::string const& word, Mention mention) {
  return error("E4025", mention,
               fmt::format("`missing` lists `{}`, but columns of `{}`, a {}, have numbers only", shown(word), file, what),
               "list the number that stands for it there, or remove it: NaN is a missing sample anyway");
}

Diagnostic damaged(std::string const& file, std::string const& what, Mention mention) {
  return error("E4023", mention, fmt::format("`{}` is damaged, or not a {}", file, what),
               "copy it again from where it was recorded; a file that is still being written can be read later");
}

Diagnostic reading_waited(std::string const& file, std::string const& what, Mention mention) {
  return error("E4023", mention, fmt::format("`{}` could not be read as a {}: the process that reads it hangs", file, what),
               "run the command again; if that does not help, the file may be damaged: copy it again, or save it as CSV");
}

Diagnostic linked_elsewhere(std::string const& file, std::string const& target, Mention mention) {
  return error("E4023", mention,
               fmt::format("`{}` has a link to another file, `{}`, and links are not followed", file, shown(target)),
               "copy the data into this file: `h5copy`, or `h5repack --merge`; or name the other file in the data block");
}

Diagnostic no_such_line(std::string const& file, std::string const& setting, int line, int lines, Mention mention) {
  return error("E4025", mention,
               fmt::format("`{} = {}`: there is no such line above the values of `{}` ({} looked at)", setting, line, file,
                           lines == 1 ? "1 line was" : fmt::format("{} lines were", lines)),
               "lines are counted from 1 at the top of the file, with empty ones and comments");
}

Diagnostic other_number_of_columns(std::string const& file, int line, int cells, int names, Mention mention) {
  return error("E4025", mention,
               fmt::format("line {} of `{}` has {}, but `columns` names {}", line, file, counted(cells, "cell"), names),
               "name all columns, also those that are not used");
}

Diagnostic open_quote(std::string const& file, int line, Mention mention) {
  return error("E4004", mention, fmt::format("a quoted cell is not closed correctly on line {} of `{}`", line, file),
               "close it with `\"` on the same line, followed by a separator; a quote inside is written `\"\"`");
}

Diagnostic ragged_row(std::string const& file, int row, int line, int cells, int columns, Mention mention) {
  return error(
      "E4005", mention,
      fmt::format("{} has {}, but the header names {}", place(file, row, line), counted(cells, "cell"), counted(columns, "column")),
      "a missing value is an empty cell between separators; numbers with a decimal comma need a separator other than the comma");
}

Diagnostic broken_table(std::string const& file, int line, Mention mention) {
  return error("E4010", mention,
               fmt::format("line {} of `{}` is not a row of values, unlike the lines above and below it", line, file),
               "correct the line or delete it; to read only the lines before it or after it, state them with `read values`");
}

Diagnostic comment_in_data(std::string const& file, int row, int line, Mention mention) {
  return error("E4006", mention, fmt::format("{} is a comment", place(file, row, line)),
               "comments are allowed only above the header");
}

Diagnostic too_many_rows(std::string const& file, int most, Mention mention) {
  return error("E4020", mention, fmt::format("`{}` has more than {} rows", file, most), "cut the record into several files");
}

Diagnostic too_few_rows(std::string const& file, int rows, Mention mention) {
  return error("E4007", mention, fmt::format("`{}` has {}", file, rows == 0 ? "no rows" : counted(rows, "row")),
               "a record needs at least 2 rows");
}

Diagnostic missing_column(std::string const& file, std::string const& column, std::vector<std::string> const& known, bool quote,
                          Mention mention) {
  if (!quote)
    return error("E4008", mention, fmt::format("`{}` has no column `{}`", file, column),
                 "the file has no numbers below its first line: check that it is the record, with the names of its columns on the "
                 "first line");
  std::string help = did_you_mean(column, known);
  if (help.empty() && known.size() == 1 && known[0].find(' ') != std::string::npos)
    help = "columns are separated by commas, semicolons or tabs, not by spaces";
  if (!help.empty()) help += help.back() == '?' ? " " : "; ";
  return error("E4008", mention, fmt::format("`{}` has no column `{}`", file, column),
               help + fmt::format("its {} {}", known.size() == 1 ? "only column is" : "columns are", column_names(known)));
}

Diagnostic repeated_column(std::string const& file, std::string const& column, Mention mention) {
  return error("E4009", mention, fmt::format("`{}` has more than one column `{}`", file, column),
               "give the columns different names");
}

Diagnostic not_a_number(Cell const& cell, std::string_view text, bool quote, Mention mention) {
  if (!quote)
    return error("E4010", mention, fmt::format("{} contains a text, not a number", place(cell)),
                 "choose a column of numbers; a missing sample of a measured column is an empty cell or NA");
  bool const decimal_comma =
      std::count(text.begin(), text.end(), ',') == 1 && text.find_first_not_of("\"0123456789+-eE,") == std::string_view::npos;
  std::string const grouped = without_groups(text);
  std::string help = "a missing sample of a measured column is an empty cell or NA; an input needs a number in every row";
  if (is_time_stamp(text) && std::count(text.begin(), text.end(), ':') == 3)
    help = fmt::format(
        "the digits after the last colon may be frames or a fraction of a second: for frames give `rate` in place of the time "
        "column; for a fraction {}",
        text.find_first_not_of("0123456789:") == std::string_view::npos
            ? "add this line to the data block: `read stamp = \"hh:mm:ss:f\"`"
            : "write `read stamp` with `hh:mm:ss:f` after the date");
  else if (is_time_stamp(text))
    help =
        "dates and times of day are read only in the time column: name this column after `time` and add `read stamp`, or give "
        "`rate` in its place";
  else if (std::size_t const d = text.find_first_of("dD");
           d != std::string_view::npos && text.find_first_not_of("0123456789+-.dD") == std::string_view::npos)
    help = fmt::format("write the exponent with `e`: `{}e{}`", text.substr(0, d), text.substr(d + 1));
  else if (decimal_comma)
    help = "write a decimal point instead of the comma";
  if (!grouped.empty())
    help = decimal_comma ? fmt::format("{}, or `{}` where it groups digits", help, grouped)
                         : fmt::format("write it without groups of digits: `{}`", grouped);
  return error("E4010", mention, fmt::format("{}: `{}` is not a number", place(cell), shown(text)), std::move(help));
}

Diagnostic row_of_units(Cell const& cell, std::string_view text, Mention mention) {
  std::string const unit = as_unit(text);
  return error("E4010", mention,
               fmt::format("{} contains words, not numbers: it seems to be a row of units below the header",
                           place(cell.file, cell.row, cell.line)),
               unit.empty()
                   ? fmt::format("delete this line; units are written in the data block, in brackets after `{}`", cell.column)
                   : fmt::format("delete this line; units are written in the data block: `{} [{}]`", cell.column, unit));
}

Diagnostic unknown_separator(std::string const& file, int line, std::string_view separator, Mention mention) {
  return error("E4002", mention,
               fmt::format("line {} of `{}` declares the separator `{}`, which is not supported", line, file, shown(separator)),
               "separate the columns by commas, semicolons or tabs");
}

Diagnostic not_finite(Cell const& cell, std::string_view text, Mention mention) {
  return error("E4011", mention, fmt::format("{} contains `{}`", place(cell), shown(text)),
               "check what produced it; a missing sample of a measured column is an empty cell or NA, and an input needs a number "
               "in every row");
}

Diagnostic out_of_range(Cell const& cell, std::string_view text, Mention mention) {
  return error("E4012", mention, fmt::format("{}: `{}` is beyond the range of floating-point numbers", place(cell), shown(text)),
               "the largest number is 1.8e308; a missing sample of a measured column is an empty cell or NA");
}

Diagnostic not_a_count(Cell const& cell, double value, Mention mention) {
  return error("E4019", mention, fmt::format("{}: {:.9g} is not a count", place(cell), value),
               "a channel with poisson or negative_binomial noise measures whole numbers from 0 on; a missing sample is an empty "
               "cell or NA");
}

Diagnostic points_or_groups(Cell const& cell, std::string_view text, Mention mention) {
  return error("E4021", mention,
               fmt::format("{}: `{}` may be a number with a decimal point or a number of thousands", place(cell), shown(text)),
               "add one of these lines to the data block: `read decimal = \".\"`, or `read decimal = \",\", thousands = \".\"`");
}

Diagnostic doubtful_sample(Cell const& cell, std::string const& value, int times, Mention mention) {
  return error(
      "E4022", mention,
      fmt::format("{}: {} (in {}) is far from all other samples, like a mark for missing samples", place(cell), value,
                  times == 1 ? "one row" : fmt::format("{} rows", times)),
      fmt::format("add this line to the data block: `read missing = \"{}\"`; or, if it is a sample, `read missing = none`", value));
}

Diagnostic stamp_among_numbers(Cell const& cell, std::string_view text, Mention mention) {
  return error(
      "E4010", mention, fmt::format("{}: `{}` is not a number", place(cell), shown(text)),
      "the cells above it are numbers: correct this cell (write a time in the unit of the column, such as seconds) or delete the "
      "line");
}

Diagnostic times_are_dates(Cell const& cell, double value, std::string_view word, bool is_text, Mention mention) {
  std::string help =
      fmt::format("add this line to the data block: `read stamp = {}`; times then begin with 0 at the first row", word);
  if (!is_text)
    help = fmt::format("write their unit in the data block: `time {}`", column_text(cell.column, find_serial_time(word)->unit));
  if (word == "days") help += fmt::format("; if they are seconds, `time {}`", column_text(cell.column, "s"));
  return error("E4029", mention,
               fmt::format("{}: {:.15g} is probably not a time in seconds of the record, but {} since {}", place(cell), value, word,
                           word == "days" ? "1900 or the year 0, as spreadsheets and MATLAB count them" : "1970"),
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
      is_text
          ? fmt::format("add one of these lines to the data block: {}; the last one where they are seconds", quoted(lines, "or"))
          : "save them as seconds: this file has no `read` line";
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

Diagnostic unit_differs(std::string const& file, std::string const& column, std::string const& stated, std::string const& found,
                        Mention mention) {
  return error("E4026", mention,
               fmt::format("column `{}` is in [{}] here, but `{}` states its unit as {}", shown(column), stated, file, found),
               "one of the two is wrong: write the unit that the numbers have, or no unit to use the one in the file");
}

Diagnostic unit_differs_from_name(std::string const& file, NamedUnit const& name, TwoUnits const& units, bool is_text,
                                  Mention mention) {
  std::string help = fmt::format("one of the two is wrong: write the unit that its numbers have, `[{}]`",
                                 units.to_write.empty() ? as_unit(units.found) : units.to_write);
  if (is_text)
    help += fmt::format(
        ", or add `read units = names` and write `{}` without a unit; where the name is wrong, name the columns with `read "
        "columns`",
        shown(name.bare));
  return error("E4026", mention,
               fmt::format("column `{}` is in [{}] here, but in `{}` its name has the unit {}", shown(name.column), units.stated,
                           file, shown(units.found)),
               std::move(help));
}

Diagnostic unit_unknown(std::string const& file, std::string const& column, std::string const& found, Mention mention) {
  return error("E4026", mention,
               fmt::format("the unit of column `{}` in `{}`{} is not known", shown(column), file,
                           found.empty() ? "" : fmt::format(", `{}`,", found)),
               fmt::format("write it in the data block, in brackets after the column: `{} [N]`", shown(column)));
}

Diagnostic unit_of_another_kind(std::string const& file, std::string const& column, std::string const& found,
                                std::string const& wanted, Mention mention) {
  return error("E4026", mention,
               fmt::format("column `{}` is in [{}] in `{}`, but [{}] is needed", shown(column), found, file, wanted),
               "use the column of the right quantity; units of one kind are converted");
}

Diagnostic missing_value(Cell const& cell, std::string const& what, Mention mention) {
  return error("E4013", mention, fmt::format("{} has no value, but {} needs one in every row", place(cell), what),
               "only measured columns may have missing samples: fill the gap in the file, or save the rows before and after it in "
               "files of their own");
}

Diagnostic gap_in_independent_rows(Cell const& first, int last, Mention mention) {
  bool const one = last == first.row;
  return error("E4013", mention,
               fmt::format("{} {}, but the model reads it in every row", place(first),
                           one ? "has no value" : fmt::format("has no values up to row {}", last)),
               fmt::format("delete {} from the file: the rows of a model without dynamics are independent, and a number that is "
                           "filled in would count as measured; later rows then have smaller numbers in `split`",
                           one ? fmt::format("row {}", last) : fmt::format("rows {}..{}", first.row, last)));
}

Diagnostic gap_in_input(Cell const& first, GapEnd const& end, SimulatedRows const& rows, FreeRows const& free, Mention mention) {
  constexpr int longest_to_fill = 3, usual_rows = 50;  // of an estimated start
  int const count = end.last - first.row + 1;
  bool const inside = first.row <= rows.last && end.last >= rows.first;
  std::string const why = inside ? fmt::format("rows {}..{} are simulated and need one", rows.first, rows.last)
                          : rows.around > 0
                              ? fmt::format(
                                    "its rule between samples uses up to {} rows before and after rows {}..{}, which are "
                                    "simulated",
                                    rows.around, rows.first, rows.last)
                              : fmt::format("rows {}..{} are simulated and read earlier rows, too", rows.first, rows.last);
  std::string const what = count == 1 ? "has no value" : fmt::format("has no values up to row {} ({} rows)", end.last, count);
  std::string help = "fill the gap in the file";
  if (count <= longest_to_fill && std::isfinite(end.before) && std::isfinite(end.after))
    help += fmt::format(" with numbers between its neighbours, {:.6g} and {:.6g}", end.before, end.after);
  if (free.last > free.first)
    help += fmt::format(", or use rows without it: `split part = rows {}..{}`{}", free.first, free.last,
                        free.first > rows.first
                            ? fmt::format(" with `start = estimated(rows = {})` in the task, or with `start = rest` if "
                                          "nothing moved just before row {}",
                                          std::min(usual_rows, (free.last - free.first + 1) / 2), free.first)
                            : std::string());
  else
    help += ", or save the rows before and after it in files of their own";
  return error("E4013", mention, fmt::format("{} {}, but {}", place(first), what, why), std::move(help));
}

Diagnostic time_not_increasing(Cell const& cell, double before, double now, Mention mention) {
  return error("E4014", mention, fmt::format("{}: time does not increase, {} comes after {}", place(cell), now, before),
               "sort the rows and remove repeated ones; if the file contains two runs, divide it into two files");
}

Diagnostic unequal_steps(int row, double step, double usual, Mention mention) {
  return error(
      "E4015", mention,
      fmt::format("`band_limited` needs equal time steps, but row {} is {:.9g} s after the row before; the mean step is {:.9g} s",
                  row, step, usual),
      "if the sampling was regular and the printed times are rounded, give `rate` instead of the time column; otherwise use "
      "`cubic` or `linear`");
}

Diagnostic unequal_lengths(std::string const& file, std::string const& a, std::size_t rows_a, std::string const& b,
                           std::size_t rows_b, Mention mention) {
  return error(
      "E4028", mention,
      fmt::format("`{}` has {} numbers and `{}` has {} in `{}`: they cannot be columns of one record", b, rows_b, a, rows_a, file),
      "give each of them a data block and a time of its own, or resample them to the same times first");
}

Diagnostic rows_outside(std::string const& file, std::string const& what, int first, int last, int rows, Mention mention) {
  return error("E4016", mention,
               fmt::format("{} selects rows {}..{}, but `{}` has {}", what, first, last, file, counted(rows, "row")),
               fmt::format("rows are numbered from 1 below the header; the last is {}", rows));
}

Diagnostic cycles_against_radians(std::string const& column, std::string const& column_unit, std::string const& declared_unit,
                                  Mention mention) {
  Diagnostic result = error("E4017", mention,
                            fmt::format("column `{}` is in [{}], but [{}] is needed: one counts cycles, the other radians, so they "
                                        "differ by a factor of 2 pi",
                                        column, column_unit, declared_unit),
                            "declare both in Hz or both in rad/s, and write the factor 2*pi where the model needs it");
  result.names = {column};
  return result;
}

}  // namespace sysid::data_errors
