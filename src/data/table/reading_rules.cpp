// One row per setting; the order of the table is that of lists and of proposed statements.
#include "data/table/reading_rules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <utility>

#include "data/cell/serial_time.hpp"
#include "data/cell/time_stamp.hpp"

namespace sysid {
namespace {

using Taken = std::string;  // empty, or what the value must be

std::optional<int> line_number(std::string const& text) {
  int value = 0;
  auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < 1) return std::nullopt;
  return value;
}

std::optional<std::string> single(ReadingValue const& value) {
  if (value.range || value.items.size() != 1) return std::nullopt;
  return value.items[0];
}

Taken take_names(ReadingRules& rules, ReadingValue const& value) {
  auto const item = single(value);
  auto const line = item ? line_number(*item) : std::nullopt;
  if (!line) return "must be the number of a line, counted from 1";
  rules.names = *line;
  return {};
}

Taken take_units(ReadingRules& rules, ReadingValue const& value) {
  auto const item = single(value);
  if (item == "names") {
    rules.units = UnitsPlace::names;
    return {};
  }
  auto const line = item ? line_number(*item) : std::nullopt;
  if (!line) return "must be the number of a line, counted from 1, or `names` if the units follow the names";
  rules.units = UnitsPlace::line;
  rules.units_line = *line;
  return {};
}

Taken take_values(ReadingRules& rules, ReadingValue const& value) {
  std::string const wanted = "must be the number of the first line with values, or a range of lines such as `5..104`";
  auto const first = value.items.empty() ? std::nullopt : line_number(value.items.front());
  if (!first || value.items.size() != (value.range ? 2U : 1U)) return wanted;
  rules.first_value = *first;
  if (!value.range) return {};
  auto const last = line_number(value.items.back());
  if (!last || *last < *first) return wanted;
  rules.last_value = *last;
  return {};
}

Taken take_columns(ReadingRules& rules, ReadingValue const& value) {
  if (value.range || value.items.empty()) return "must list the names of all columns: `(t, force, y)`";
  for (std::size_t i = 0; i < value.items.size(); ++i) {
    if (value.items[i].empty()) return "must list names, none of them empty";
    if (std::find(value.items.begin(), value.items.begin() + static_cast<std::ptrdiff_t>(i), value.items[i]) !=
        value.items.begin() + static_cast<std::ptrdiff_t>(i))
      return fmt::format("must list different names; `{}` is listed twice", value.items[i]);
  }
  rules.columns = value.items;
  return {};
}

/// Signs and the words that stand for those that are hard to see.
struct Sign {
  char sign;
  std::string_view word;
};
constexpr Sign signs[] = {{',', "comma"}, {';', "semicolon"}, {'\t', "tab"},       {' ', "blank"},
                          {'|', "bar"},   {'.', "point"},     {'\'', "apostrophe"}};

std::optional<char> sign_of(ReadingValue const& value, std::string_view allowed) {
  auto const item = single(value);
  if (!item) return std::nullopt;
  for (Sign const& each : signs)
    if ((*item == each.word || (item->size() == 1 && item->front() == each.sign)) && allowed.find(each.sign) != allowed.npos)
      return each.sign;
  return std::nullopt;
}

std::string sign_text(char sign) {
  if (sign == 0) return {};
  for (Sign const& each : signs)
    if (each.sign == sign && (sign == '\t' || sign == ' ')) return std::string(each.word);
  return quoted_text(std::string_view(&sign, 1));
}

Taken take_separator(ReadingRules& rules, ReadingValue const& value) {
  auto const sign = sign_of(value, ",;\t |");
  if (!sign) return "must be `\",\"`, `\";\"`, `\"|\"`, `tab` or `blank`";
  rules.separator = *sign;
  return {};
}
Taken take_decimal(ReadingRules& rules, ReadingValue const& value) {
  auto const sign = sign_of(value, ".,");
  if (!sign) return "must be `\",\"` or `\".\"`";
  rules.decimal = *sign;
  rules.decimal_given = true;
  return {};
}
Taken take_thousands(ReadingRules& rules, ReadingValue const& value) {
  auto const sign = sign_of(value, ".,' ");
  if (!sign) return "must be `\".\"`, `\",\"`, `\"'\"` or `blank`";
  rules.thousands = *sign;
  return {};
}
Taken take_encoding(ReadingRules& rules, ReadingValue const& value) {
  auto const item = single(value);
  if (item == "utf8")
    rules.encoding = Encoding::utf8;
  else if (item == "latin1")
    rules.encoding = Encoding::latin1;
  else if (item == "utf16")
    rules.encoding = Encoding::utf16;
  else
    return "must be `latin1`, `utf16` or `utf8`";
  return {};
}
Taken take_missing(ReadingRules& rules, ReadingValue const& value) {
  if (value.range || value.items.empty()) return "must be a word, or several in parentheses: `(\"NaN\", \"-9999\")`";
  rules.asked_for_missing = true;
  rules.missing.clear();
  rules.no_other_mark = false;
  for (std::size_t i = 0; i < value.items.size(); ++i)  // "none" in quotes is a word of the file
    if (value.is_word(i, "none"))
      rules.no_other_mark = true;
    else
      rules.missing.push_back(value.items[i]);
  return {};
}
Taken take_stamp(ReadingRules& rules, ReadingValue const& value) {
  auto const item = single(value);
  if (item && (StampPattern::parse(*item) || is_stamp_word(*item))) {
    rules.stamp = *item;
    return {};
  }
  return "must be `iso`; `duration`; for numbers that count from a date, `seconds`, `milliseconds`, `microseconds`, `nanoseconds` "
         "or "
         "`days`; or a pattern such as `\"DD.MM.YYYY hh:mm:ss,f\"` (YYYY, YY, MM, MMM, DD, DDD, hh, mm, ss, f, AP, zone)";
}
Taken take_date(ReadingRules& rules, ReadingValue const& value) {
  auto const item = single(value);
  if (!item || item->empty()) return "must be the name of a column";
  rules.date = *item;
  return {};
}
Taken take_ragged(ReadingRules& rules, ReadingValue const& value) {
  auto const item = single(value);
  if (item != "yes" && item != "no") return "must be `yes` or `no`";
  rules.ragged = item == "yes";
  return {};
}
Taken take_comments(ReadingRules& rules, ReadingValue const& value) {
  auto const item = single(value);
  constexpr std::string_view allowed = "#%!/;*$@";
  if (!item || item->size() != 1 || allowed.find(item->front()) == allowed.npos)
    return "must be the character that comments begin with: `\"#\"`, `\"%\"`, `\"!\"`, `\"/\"`, `\";\"`, `\"*\"`, `\"$\"` or "
           "`\"@\"`";
  rules.comments = item->front();
  return {};
}

constexpr ReadingRow rows[] = {
    {"names", "names = 4", "the line that names the columns, counted from 1 at the top of the file", "", &take_names},
    {"units", "units = 5", "the line with the units of the columns, or `names` if the units follow the names: `Force (N)`", "names",
     &take_units},
    {"values", "values = 7", "the first line with values, or a range of lines: `7..1006`", "", &take_values},
    {"columns", "columns = (t, force, y)", "names of all columns in order, if the file has none, or repeated or empty ones", "",
     &take_columns},
    {"encoding", "encoding = latin1", "how characters are stored: latin1 (and Windows-1252), utf16 or utf8", "latin1 utf16 utf8",
     &take_encoding},
    {"separator", "separator = \";\"", "what stands between cells: \",\", \";\", \"|\", tab, or blank for any number of blanks",
     "tab blank", &take_separator},
    {"decimal", "decimal = \",\"", "the decimal sign: \",\" or \".\"", "", &take_decimal},
    {"thousands", "thousands = \".\"", "the sign between groups of three digits: \".\", \",\", \"'\" or blank", "blank",
     &take_thousands},
    {"missing", "missing = (\"NaN\", \"-9999\")",
     "words and numbers that stand for a missing sample; `none`, alone or in the list: all other numbers are samples", "none",
     &take_missing},
    {"stamp", "stamp = \"DD.MM.YYYY hh:mm:ss\"",
     "the pattern of dates and times in the time column, `iso`, or `duration` (`0.01 sec`); if it has numbers that count from a "
     "date, their unit (`seconds`, `days`); all become seconds since the first row",
     "iso duration seconds milliseconds microseconds nanoseconds days", &take_stamp},
    {"date", "date = \"Datum\"", "the column with the date, where the time column holds the time of day", "", &take_date},
    {"ragged", "ragged = yes", "lines may have extra empty cells at the end, or lack the last cells, which are then missing",
     "yes no", &take_ragged},
    {"comments", "comments = \"%\"", "the character that begins a comment; comments may then also be between the rows", "",
     &take_comments},
};

std::string list_of(std::vector<std::string> const& items) {
  std::string text;  // empty of no items
  for (std::string const& item : items) text += (text.empty() ? "" : ", ") + quoted_text(item);
  return items.size() < 2 ? text : "(" + text + ")";
}

}  // namespace

std::span<ReadingRow const> reading_rows() { return rows; }

ReadingRow const* find_reading(std::string_view name) {
  auto const found = std::find_if(std::begin(rows), std::end(rows), [&](ReadingRow const& row) { return row.name == name; });
  return found == std::end(rows) ? nullptr : found;
}

std::string refuse(ReadingRules const& rules) {
  if (rules.thousands == rules.decimal)
    return fmt::format("`thousands` and `decimal` are both `{}`{}", rules.decimal,
                       rules.decimal == '.' && !rules.decimal_given ? ": add `decimal = \",\"`" : "");
  if (rules.separator != 0 && rules.separator == rules.decimal)
    return fmt::format("`separator` and `decimal` are both `{}`", rules.decimal);
  if (rules.separator != 0 && rules.separator == rules.thousands) return "`separator` and `thousands` are the same";
  if (!rules.date.empty() && rules.stamp.empty()) return "`date` needs `stamp`, the pattern of the date and the time after it";
  if (!rules.date.empty() && rules.stamp != "iso" && is_stamp_word(rules.stamp))
    return fmt::format(
        "`date` goes with a pattern of the date and the time of day, and not with `stamp = {}`: write such a pattern, or leave "
        "`date` out if all rows are of one day",
        rules.stamp);
  int const above = std::max(rules.names, rules.units_line);
  if (rules.first_value != 0 && rules.first_value <= above) return "`values` must lie below `names` and `units`";
  return {};
}

std::string quoted_text(std::string_view text) {
  std::string out = "\"";
  for (char const c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

std::string column_text(std::string_view column, std::string_view unit) {
  constexpr std::string_view reserved[] = {"if", "then", "else", "and", "or", "not"};
  bool const is_name = !column.empty() && begins_a_name(column[0]) &&
                       std::all_of(column.begin(), column.end(), is_part_of_a_name) &&
                       std::find(std::begin(reserved), std::end(reserved), column) == std::end(reserved);
  return (is_name ? std::string(column) : quoted_text(column)) + (unit.empty() ? "" : fmt::format(" [{}]", unit));
}

namespace {

/// A setting as it is written; empty where it has its default.
struct Written {
  std::string_view key;
  std::string value;
};

std::string missing_text(ReadingRules const& rules) {
  if (rules.missing.empty()) return rules.asked_for_missing ? "none" : "";
  if (!rules.no_other_mark) return list_of(rules.missing);
  std::string text;
  for (std::string const& word : rules.missing) text += quoted_text(word) + ", ";
  return "(" + text + "none)";
}

std::vector<Written> written_settings(ReadingRules const& rules) {
  auto const line = [](int number) { return number == 0 ? std::string() : std::to_string(number); };
  std::string const values =
      rules.last_value != 0 ? fmt::format("{}..{}", rules.first_value, rules.last_value) : line(rules.first_value);
  return {{"names", line(rules.names)},
          {"units", rules.units == UnitsPlace::names ? "names" : line(rules.units_line)},
          {"values", values},
          {"columns", list_of(rules.columns)},
          {"encoding", rules.encoding == Encoding::utf8     ? ""
                       : rules.encoding == Encoding::latin1 ? "latin1"
                                                            : "utf16"},
          {"separator", sign_text(rules.separator)},
          {"decimal", rules.decimal != '.' || rules.decimal_given ? sign_text(rules.decimal) : ""},
          {"thousands", sign_text(rules.thousands)},
          {"missing", missing_text(rules)},
          {"stamp", rules.stamp.empty() || is_stamp_word(rules.stamp) ? rules.stamp : quoted_text(rules.stamp)},
          {"date", rules.date.empty() ? "" : quoted_text(rules.date)},
          {"ragged", rules.ragged ? "yes" : ""},
          {"comments", rules.comments == 0 ? "" : quoted_text(std::string_view(&rules.comments, 1))}};
}

}  // namespace

std::string reading_statement(ReadingRules const& rules) { return added_settings(rules, ReadingRules{}).value_or(""); }

std::optional<std::string> added_settings(ReadingRules const& rules, ReadingRules const& current) {
  std::vector<Written> const wanted = written_settings(rules), there = written_settings(current);
  std::string text;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i].value == there[i].value) continue;
    if (!there[i].value.empty()) return std::nullopt;
    text += fmt::format("{}{} = {}", text.empty() ? "read " : ", ", wanted[i].key, wanted[i].value);
  }
  return text;
}

bool needs_whole_file(ReadingRules const& rules) {
  return rules.names != 0 || rules.units == UnitsPlace::line || rules.first_value != 0 || !rules.columns.empty() ||
         rules.encoding != Encoding::utf8 || !rules.stamp.empty() || rules.comments != 0;
}

}  // namespace sysid
