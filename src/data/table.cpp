// Reads CSV strictly. One pass finds where every cell begins; numbers are parsed when a column is asked for.
#include "data/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/system/digest.hpp"
#include "core/system/files.hpp"
#include "core/system/interrupt.hpp"
#include "core/system/memory.hpp"
#include "core/text/words.hpp"
#include "data/file_errors.hpp"

namespace sysid {
namespace {

constexpr int many = 1 << 16;          // rows between two looks at the signals
constexpr double large = 1e8;          // bytes: of less nobody runs out of memory
constexpr double memory_per_byte = 3;  // of a file: its text, where its cells begin, its numbers

constexpr std::string_view blanks = " \t";  // within a cell a line end is text

bool is_quoted(std::string_view trimmed_cell) {
  return trimmed_cell.size() >= 2 && trimmed_cell.front() == '"' && trimmed_cell.back() == '"';
}

/// The text between the quotes, `""` read as one quote; an unquoted cell as it stands.
std::string unquoted(std::string_view cell) {
  cell = trimmed(cell, blanks);
  if (!is_quoted(cell)) return std::string(cell);
  std::string text;
  for (std::size_t i = 1; i + 1 < cell.size(); ++i) {
    text += cell[i];
    if (cell[i] == '"') ++i;
  }
  return std::string(trimmed(text, blanks));
}

/// Well-formed UTF-8 (Unicode 15, table 3-7) without NUL.
bool is_utf8(std::string_view text) {
  auto const* p = reinterpret_cast<unsigned char const*>(text.data());
  auto const* const end = p + text.size();
  auto const continues = [&](std::ptrdiff_t i, unsigned low = 0x80, unsigned high = 0xbf) {
    return end - p > i && p[i] >= low && p[i] <= high;
  };
  while (p != end) {
    unsigned const lead = *p;
    if (lead == 0) return false;
    if (lead < 0x80) {
      p += 1;
    } else if (lead >= 0xc2 && lead <= 0xdf && continues(1)) {
      p += 2;
    } else if ((lead & 0xf0) == 0xe0 && continues(1, lead == 0xe0 ? 0xa0 : 0x80, lead == 0xed ? 0x9f : 0xbf) && continues(2)) {
      p += 3;
    } else if (lead >= 0xf0 && lead <= 0xf4 && continues(1, lead == 0xf0 ? 0x90 : 0x80, lead == 0xf4 ? 0x8f : 0xbf) &&
               continues(2) && continues(3)) {
      p += 4;
    } else {
      return false;
    }
  }
  return true;
}

enum class Kind { number, missing, text, not_finite, out_of_range };

Kind parse_number(std::string_view cell, double& value) {
  cell = trimmed(cell, blanks);
  if (is_quoted(cell)) cell = trimmed(cell.substr(1, cell.size() - 2), blanks);
  if (cell.empty() || cell == "NA") return Kind::missing;
  if (cell.front() == '+') {
    cell.remove_prefix(1);
    if (cell.empty() || cell.front() == '-') return Kind::text;
  }
  char const* const end = cell.data() + cell.size();
  auto const [stop, error] = std::from_chars(cell.data(), end, value);
  if (error == std::errc::invalid_argument || stop != end) return Kind::text;
  if (error == std::errc::result_out_of_range) {
    // Too small for a double is zero to within one; too large is a mistake.
    long double wide = 0;
    if (std::from_chars(cell.data(), end, wide).ec != std::errc{} || std::fabs(wide) > 1) return Kind::out_of_range;
    value = 0;
  }
  return std::isfinite(value) ? Kind::number : Kind::not_finite;
}

/// Calls cell(begin, end) for each cell of the line [begin, end) of `bytes`; false when a quoted cell does not end properly.
template <class OnCell>
bool split(std::string const& bytes, std::size_t begin, std::size_t end, char separator, OnCell on_cell) {
  std::size_t cell = begin;
  for (;;) {
    std::size_t at = cell;
    while (at < end && (bytes[at] == ' ' || bytes[at] == '\t') && bytes[at] != separator) ++at;
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
      while (at < end && (bytes[at] == ' ' || bytes[at] == '\t') && bytes[at] != separator) ++at;
      if (at < end && bytes[at] != separator) return false;
    } else {
      while (at < end && bytes[at] != separator) ++at;
    }
    on_cell(cell, at);
    if (at >= end) return true;
    cell = at + 1;
  }
}

/// Which of comma, semicolon and tab occurs most often outside quotes; the comma when none does.
char find_separator(std::string_view header) {
  std::size_t counts[3] = {};
  constexpr std::string_view candidates = ",;\t";
  bool quoted = false;
  for (char const c : header) {
    if (c == '"') quoted = !quoted;
    std::size_t const which = candidates.find(c);
    if (!quoted && which != std::string_view::npos) ++counts[which];
  }
  return candidates[static_cast<std::size_t>(std::max_element(counts, counts + 3) - counts)];
}

/// Walks the lines of a text; `\n`, or `\r` where there is no `\n`, ends one, a `\r` before it does not belong to it.
class Lines {
 public:
  Lines(std::string const& bytes, std::size_t from)
      : bytes_(bytes), next_(from), end_character_(bytes.find('\n') == std::string::npos ? '\r' : '\n') {}

  bool next() {
    if (next_ >= bytes_.size()) return false;
    begin = next_;
    void const* const found = std::memchr(bytes_.data() + begin, end_character_, bytes_.size() - begin);
    end = found == nullptr ? bytes_.size() : static_cast<std::size_t>(static_cast<char const*>(found) - bytes_.data());
    next_ = end + 1;
    if (end > begin && bytes_[end - 1] == '\r') --end;
    ++number;
    return true;
  }
  std::string_view text() const { return std::string_view(bytes_).substr(begin, end - begin); }

  std::size_t begin = 0, end = 0;
  int number = 0;

 private:
  std::string const& bytes_;
  std::size_t next_;
  char end_character_;
};

/// `sep=;`, which spreadsheets write above the header: what follows `sep=`.
std::optional<std::string_view> stated_separator(std::string_view line) {
  if (line.size() >= 2 && line.front() == '"' && line.back() == '"') line = line.substr(1, line.size() - 2);
  if (line.size() < 5 || !(line.starts_with("sep=") || line.starts_with("SEP=") || line.starts_with("Sep="))) return std::nullopt;
  return line.size() == 5 || trimmed(line, blanks).size() == 5 ? std::optional(line.substr(4)) : std::nullopt;
}

/// Such as `1,5` or `3.2 V`: a number in another notation, and no word of a text.
bool like_a_number(std::string_view cell) {
  std::size_t const digit = cell.find_first_of("0123456789");
  return digit != cell.npos && digit == cell.find_first_not_of("+-.,( ") &&
         cell.find_first_not_of("0123456789+-.,eE:/%() ") >= cell.size() - std::min<std::size_t>(3, cell.size());
}

/// Such as `n/a` or `#REF!`, which stand in the place of a number. A file without numbers may hold anything in as few characters.
bool like_a_gap(std::string_view cell) { return cell.size() <= 5; }

bool all_numbers(std::vector<std::string> const& names) {
  return std::all_of(names.begin(), names.end(), [](std::string const& name) {
    double ignored = 0;
    return parse_number(name, ignored) != Kind::text;
  });
}

}  // namespace

Table Table::read(std::string const& path, std::optional<Span> mention, std::string const& shown_path) {
  double const size = static_cast<double>(regular_file_size(path));
  if (size > large) try {
      require_memory(fmt::format("reading `{}`", path), memory_per_byte * size,
                     "cut the record, or remove columns that are not used");
    } catch (UserError const& error) {
      Diagnostic placed = error.diagnostic();
      if (mention) placed.primary = Label{*mention, {}};
      throw UserError(std::move(placed));
    }
  return parse(shown_path.empty() ? path : shown_path, read_regular_file(path), mention);
}

Table Table::parse(std::string name, std::string bytes, std::optional<Span> mention, int rows_before) {
  Table table;
  table.rows_before_ = rows_before;
  table.name_ = std::move(name);
  table.bytes_ = std::move(bytes);
  table.digest_ = sha256(table.bytes_);
  if (!is_utf8(table.bytes_)) throw UserError(data_errors::not_text(table.name_, mention));

  Lines line(table.bytes_, table.bytes_.starts_with("\xef\xbb\xbf") ? 3 : 0);
  bool header_found = false;
  std::optional<char> stated;
  while (!header_found && line.next()) {
    std::string_view const text = trimmed(line.text(), blanks);
    if (auto const separator = stated_separator(line.text()); separator && line.number == 1) {
      if (std::string_view(",;\t").find(separator->front()) == std::string_view::npos)
        throw UserError(data_errors::unknown_separator(table.name_, line.number, *separator, mention));
      stated = separator->front();
      continue;
    }
    if (text.starts_with('#')) table.comments_.emplace_back(trimmed(text.substr(1), blanks));
    header_found = !text.empty() && !text.starts_with('#');
  }
  if (!header_found) throw UserError(data_errors::no_header(table.name_, mention));
  table.header_line_ = line.number;
  char const separator = stated ? *stated : find_separator(line.text());
  bool closed = split(table.bytes_, line.begin, line.end, separator, [&](std::size_t begin, std::size_t end) {
    table.columns_.push_back(unquoted(std::string_view(table.bytes_).substr(begin, end - begin)));
  });
  if (!closed) throw UserError(data_errors::open_quote(table.name_, line.number, mention));
  if (all_numbers(table.columns_))
    throw UserError(data_errors::header_of_numbers(table.name_, line.number, !table.comments_.empty(), mention));

  int const columns = static_cast<int>(table.columns_.size());
  int empty_lines = 0;  // not rows when they end the file
  auto const add_row = [&](std::size_t begin, std::size_t end, int number) {
    int cells = 0;
    if (table.rows_ == std::numeric_limits<int>::max())
      throw UserError(data_errors::too_many_rows(table.name_, table.rows_, mention));
    if (++table.rows_ % many == 0) stop_if_interrupted();
    closed = split(table.bytes_, begin, end, separator, [&](std::size_t cell_begin, std::size_t) {
      if (++cells <= columns) table.cells_.push_back(cell_begin);
    });
    if (!closed) throw UserError(data_errors::open_quote(table.name_, rows_before + number, mention));
    if (cells != columns)
      throw UserError(
          data_errors::ragged_row(table.name_, rows_before + table.rows_, rows_before + number, cells, columns, mention));
    table.cells_.push_back(end + 1);
  };
  while (line.next()) {
    std::string_view const text = line.text();
    if (separator == '\t' ? text.find_first_not_of(' ') == std::string_view::npos : trimmed(text, blanks).empty()) {
      ++empty_lines;
      continue;
    }
    for (; empty_lines > 0; --empty_lines) add_row(line.begin, line.begin, line.number - empty_lines);
    if (trimmed(text, blanks).starts_with('#'))
      throw UserError(data_errors::comment_in_data(table.name_, rows_before + table.rows_ + 1, rows_before + line.number, mention));
    add_row(line.begin, line.end, line.number);
  }
  return table;
}

std::string_view Table::cell(int row, int column) const {
  std::size_t const at = static_cast<std::size_t>(row - 1) * (columns_.size() + 1) + static_cast<std::size_t>(column);
  return std::string_view(bytes_).substr(cells_[at], cells_[at + 1] - 1 - cells_[at]);
}

bool Table::names_units() const {
  if (rows_ < 2) return false;
  auto const kind = [&](int row, int column) {
    double ignored = 0;
    return parse_number(cell(row, column), ignored);
  };
  bool numbers_follow = false;
  for (int column = 0; column < static_cast<int>(columns_.size()); ++column) {
    Kind const first = kind(1, column);
    if (first != Kind::text && first != Kind::missing) return false;
    numbers_follow = numbers_follow || (first == Kind::text && kind(2, column) == Kind::number);
  }
  return numbers_follow;
}

bool Table::is_record() const {
  constexpr int looked_at = 10;
  for (int row = 1; row <= std::min(rows_, looked_at); ++row)
    for (int column = 0; column < static_cast<int>(columns_.size()); ++column)
      if (std::string_view const text = cell(row, column);
          text.find_first_of("0123456789") != text.npos && text.find_first_not_of("0123456789+-.,eE \t\"") == text.npos)
        return true;  // a number, or several where the separator is not the one that the table was read with
  return false;
}

std::vector<double> Table::numbers(std::string const& column, std::optional<Span> mention) const {
  auto const found = std::find(columns_.begin(), columns_.end(), column);
  if (found == columns_.end() || column.empty())
    throw UserError(data_errors::missing_column(name_, column, columns_, is_record(), mention));
  if (std::find(found + 1, columns_.end(), column) != columns_.end())
    throw UserError(data_errors::repeated_column(name_, column, mention));
  int const index = static_cast<int>(found - columns_.begin());
  std::vector<double> values(static_cast<std::size_t>(rows_));
  bool any = false;  // numbers so far
  for (int row = 1; row <= rows_; ++row) {
    if (row % many == 0) stop_if_interrupted();
    double& value = values[static_cast<std::size_t>(row - 1)];
    std::string_view const text = cell(row, index);
    Kind const kind = parse_number(text, value);
    if (kind == Kind::number) {
      any = true;
      continue;
    }
    if (kind == Kind::missing) {
      value = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    data_errors::Cell const place{name_, rows_before_ + row, line(row), column};
    std::string_view const shown = trimmed(text, blanks);
    if (kind == Kind::text && rows_before_ + row == 1 && names_units())
      throw UserError(data_errors::row_of_units(place, shown, mention));
    // A model of unknown origin may name any file as data: what is no number of a record is not repeated.
    bool const shows = any || like_a_number(shown) || (like_a_gap(shown) && is_record());
    throw UserError(kind == Kind::not_finite     ? data_errors::not_finite(place, shown, mention)
                    : kind == Kind::out_of_range ? data_errors::out_of_range(place, shown, mention)
                                                 : data_errors::not_a_number(place, shown, shows, mention));
  }
  return values;
}

}  // namespace sysid
