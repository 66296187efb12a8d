#include "data/table/cell_errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text/words.hpp"
#include "data/cell/cells.hpp"
#include "data/cell/time_stamp.hpp"
#include "data/cell/unit_text.hpp"
#include "data/table/reading_rules.hpp"

namespace sysid::data_errors {
namespace {

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
  else if (auto const split = split_number(text); split && cell.row == 1)
    help = fmt::format("save the numbers without their units, and write the unit in the data block: `{}`",
                       column_text(cell.column, split->unit));
  else if (split)
    help = fmt::format("write the number without its unit: `{}`", split->number);
  else if (decimal_comma)
    help = "write a decimal point instead of the comma";
  if (!grouped.empty())
    help = decimal_comma ? fmt::format("{}, or `{}` if it groups digits", help, grouped)
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
    help += fmt::format(" with numbers between its neighbours, which are {:.6g} and {:.6g}", end.before, end.after);
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

}  // namespace sysid::data_errors
