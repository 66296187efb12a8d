// The wording of data errors. Messages are lower case without a full stop; `help` states what to do.
#include "data/file_errors.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/numeric/unit.hpp"
#include "core/text/utf8.hpp"
#include "core/text/words.hpp"

namespace sysid::data_errors {
namespace {

Diagnostic error(std::string code, Mention mention, std::string message, std::string help) {
  Diagnostic result{Severity::error, std::move(code), std::move(message), {}, {}, std::move(help)};
  if (mention) result.primary = Label{*mention, {}};
  return result;
}

std::string place(std::string const& file, int row, int line) { return fmt::format("`{}` row {} (line {})", file, row, line); }

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

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Digits in groups between the signs of dates and times: `2024-05-01 12:00:00.5`, `1.5.2024`, `5/1/24 3:00 PM`, `12:00:01`.
bool is_time_stamp(std::string_view text) {
  if (text.size() >= 2 && text.front() == '"') text = text.substr(1, text.size() - 2);
  if (text.find_first_not_of("0123456789-/.:,+ TZAPMapm") != std::string_view::npos || text.empty() || !is_digit(text[0]))
    return false;
  auto const count = [&](char sign) { return std::count(text.begin(), text.end(), sign); };
  std::size_t const dash = text.find('-', 1);
  bool const by_dashes = count('-') >= 2 && dash != std::string_view::npos && is_digit(text[dash - 1]);
  return count(':') > 0 || count('/') == 2 || by_dashes ||
         (count('.') == 2 && text.size() <= 10 && text.find_first_of(",' ") == std::string_view::npos &&
          text.rfind('.') + 5 == text.size());
}

/// `1,234.5`, `1.234,5`, `1'234`: a number whose digits stand in groups of three, as it is to be written; else empty.
/// What stands in brackets or alone, where it is products and powers of known units; else empty. A model of unknown origin may name
/// any file as data, so what is no unit is not repeated.
std::string as_unit(std::string_view text) {
  constexpr std::size_t longest = 24;
  for (std::string_view const pair : {"[]", "()"})
    if (text.size() > 2 && text.front() == pair[0] && text.back() == pair[1]) text = text.substr(1, text.size() - 2);
  constexpr std::ptrdiff_t exponents = 4;  // digits
  if (text.empty() || text.size() > longest || std::count_if(text.begin(), text.end(), is_digit) > exponents) return {};
  constexpr std::string_view between = " */^().0123456789+-";
  bool any = false;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t const begin = text.find_first_not_of(between, at);
    if (begin == std::string_view::npos) break;
    at = std::min(text.find_first_of(between, begin), text.size());
    if (!unit_atom(text.substr(begin, at - begin))) return {};
    any = true;
  }
  return any ? std::string(text) : std::string();
}

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
      if (i >= text.size() || !is_digit(text[i])) return {};
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

Diagnostic not_text(std::string const& file, Mention mention) {
  return error("E4003", mention, fmt::format("`{}` is not UTF-8 text", file),
               "save the record as CSV in UTF-8; spreadsheets and .mat files are not read");
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
  if (is_time_stamp(text))
    help =
        "dates and times of day are not read: write the seconds since the start in this column, or `rate` with the sampling rate "
        "in "
        "place of the time column";
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

Diagnostic missing_value(Cell const& cell, std::string const& what, Mention mention) {
  return error("E4013", mention, fmt::format("{} has no value, but {} needs one in every row", place(cell), what),
               "only measured columns may have missing samples: fill the gap, or cut the record there");
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
