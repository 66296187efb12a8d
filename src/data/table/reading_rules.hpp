// How a text file is written where it is not plain CSV: what `read` in a data block says. One table lists the settings.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

enum class Encoding { utf8, latin1, utf16 };
enum class UnitsPlace { none, names, line };

struct ReadingRules {
  int names = 0;                        // the line of the names; 0: the first that is neither empty nor a comment
  UnitsPlace units = UnitsPlace::none;  // where units are read
  int units_line = 0;                   // of UnitsPlace::line
  int first_value = 0, last_value = 0;  // lines; 0: below the names and the units, to the end
  std::vector<std::string> columns;     // names in place of those in the file
  char separator = 0;                   // 0: found in the line of the names; ' ': any blanks
  char decimal = '.';
  char thousands = 0;  // between groups of three digits; 0: nowhere
  Encoding encoding = Encoding::utf8;
  std::vector<std::string> missing;  // words, and numbers, that stand for a missing sample, beside an empty cell and NA
  bool asked_for_missing = false;    // `missing` was given, though it may be `none`
  bool no_other_mark = false;        // `none` was among them: no other number stands for a missing sample
  bool decimal_given = false;        // `decimal` was given
  std::string stamp;    // the pattern of date-time stamps in the time column, `iso`, `duration`, or a SerialTime's word
  std::string date;     // the column with the date, where the time column holds the time of day
  bool ragged = false;  // rows may have more empty cells at their end than the names, or fewer cells
  char comments = 0;    // begins lines that are left out, above the names and below

  friend bool operator==(ReadingRules const&, ReadingRules const&) = default;
};

/// What stands after `=`: `","`, `5`, `5..20`, `("NaN", "n/a")`.
struct ReadingValue {
  std::vector<std::string> items;
  bool range = false;          // two items with `..` between them
  std::vector<bool> quoted{};  // of the items; empty: none is a text in quotes
  bool is_word(std::size_t item, std::string_view word) const {
    return items[item] == word && !(item < quoted.size() && quoted[item]);
  }
  friend bool operator==(ReadingValue const&, ReadingValue const&) = default;
};

struct ReadingRow {
  std::string_view name, usage, summary;
  std::string_view choices;  // words that may follow, separated by blanks
  /// Empty when taken, else what the value must be.
  std::string (*take)(ReadingRules&, ReadingValue const&);
};

std::span<ReadingRow const> reading_rows();
ReadingRow const* find_reading(std::string_view name);

/// Why these settings do not go with each other; empty when they do.
std::string refuse(ReadingRules const& rules);

/// `read names = 4, decimal = ","`: the statement that says what differs from the defaults; empty where nothing does.
std::string reading_statement(ReadingRules const& rules);
/// The statement with what `rules` says and `current` does not; nothing where they contradict each other.
std::optional<std::string> added_settings(ReadingRules const& rules, ReadingRules const& current);
/// A text of the language in quotes.
std::string quoted_text(std::string_view text);

/// Of names of the language: letters of ASCII and `_`, and digits behind the first.
constexpr bool begins_a_name(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
constexpr bool is_part_of_a_name(char c) { return begins_a_name(c) || (c >= '0' && c <= '9'); }
/// As a column is written in a block: in quotes where it is no name; unit: empty, or what stands in brackets behind it.
std::string column_text(std::string_view column, std::string_view unit);

/// What is read of a file depends on the places of its lines, so rows that arrive one by one cannot be read by them.
bool needs_whole_file(ReadingRules const& rules);

}  // namespace sysid
