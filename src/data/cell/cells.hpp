// Lines and cells of a text, as places in it.
#pragma once
#include <cstddef>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include "core/text/words.hpp"

namespace sysid {

inline constexpr std::string_view cell_blanks = " \t";                                           // within a cell a line end is text
inline constexpr std::string_view wide_blanks[] = {"\xc2\xa0", "\xe2\x80\xaf", "\xe2\x80\x89"};  // unbreakable, narrow, thin

constexpr bool is_decimal_digit(char c) { return c >= '0' && c <= '9'; }

/// Walks the lines of a text; `\n`, or `\r` where there is no `\n`, ends one, a `\r` before it does not belong to it.
class Lines {
 public:
  explicit Lines(std::string const& bytes) : bytes_(bytes), end_character_(bytes.find('\n') == std::string::npos ? '\r' : '\n') {}

  bool next();
  std::string_view text() const { return std::string_view(bytes_).substr(begin, end - begin); }

  std::size_t begin = 0, end = 0;
  int number = 0;

 private:
  std::string const& bytes_;
  std::size_t next_ = 0;
  char end_character_;
};

/// Calls cell(begin, end) for each cell of the line [begin, end) of `bytes`; false when a quoted cell does not end properly. The
/// separator ' ' stands for any number of blanks and tabs.
template <class OnCell>
bool split_cells(std::string const& bytes, std::size_t begin, std::size_t end, char separator, OnCell on_cell) {
  auto const blank = [&](std::size_t at) { return bytes[at] == ' ' || bytes[at] == '\t'; };
  bool const any_blanks = separator == ' ';
  if (any_blanks) {
    while (begin < end && blank(begin)) ++begin;
    while (end > begin && blank(end - 1)) --end;
  }
  auto const separates = [&](std::size_t at) { return any_blanks ? blank(at) : bytes[at] == separator; };
  for (std::size_t cell = begin;;) {
    std::size_t at = cell;
    while (at < end && blank(at) && !separates(at)) ++at;
    if (at < end && bytes[at] == '"') {
      for (++at;; ++at) {
        if (at >= end) return false;
        if (bytes[at] != '"') continue;
        if (at + 1 < end && bytes[at + 1] == '"') {
          ++at;
          continue;
        }
        break;
      }
      ++at;
      while (at < end && blank(at) && !separates(at)) ++at;
      if (at < end && !separates(at)) return false;
    } else {
      while (at < end && !separates(at)) ++at;
    }
    on_cell(cell, at);
    if (at >= end) return true;
    cell = at + 1;
    while (any_blanks && cell < end && blank(cell)) ++cell;
  }
}

bool is_quoted_cell(std::string_view trimmed_cell);
/// The text between the quotes, `""` read as one quote; an unquoted cell as it stands. Without blanks around.
std::string unquoted_cell(std::string_view cell);

/// With blanks in place of wide ones: programs write a narrow one before PM.
std::string with_plain_blanks(std::string_view text);

/// Which of comma, semicolon and tab occurs most often outside quotes; the comma when none does.
char find_separator(std::string_view header);

/// `sep=;`, which spreadsheets write above the header: what follows `sep=`.
std::optional<std::string_view> stated_separator(std::string_view line);

}  // namespace sysid
