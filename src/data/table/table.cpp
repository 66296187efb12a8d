// Reads tables strictly. Numbers are parsed when a column is asked for.
#include "data/table/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/system/digest.hpp"
#include "core/system/interrupt.hpp"
#include "core/text/words.hpp"
#include "data/cell/cells.hpp"
#include "data/cell/doubtful_number.hpp"
#include "data/cell/serial_time.hpp"
#include "data/cell/time_stamp.hpp"
#include "data/cell/unit_text.hpp"
#include "data/table/cell_errors.hpp"
#include "data/table/encoding.hpp"
#include "data/table/file_errors.hpp"
#include "data/table/gzip.hpp"
#include "data/table/proposal.hpp"
#include "data/table/record_bytes.hpp"
#include "data/table/table_parser.hpp"
#include "data/table/time_errors.hpp"

namespace sysid {
namespace {

constexpr int rows_between_looks = 1 << 16;  // rows between two looks at the signals

/// Such as `1,5` or `3.2 V`: a number in another notation, and no word of a text.
bool like_a_number(std::string_view cell) {
  std::size_t const digit = cell.find_first_of("0123456789");
  if (split_number(cell)) return true;
  return digit != cell.npos && digit == cell.find_first_not_of("+-.,( ") &&
         cell.find_first_not_of("0123456789+-.,eE:/%() ") >= cell.size() - std::min<std::size_t>(3, cell.size());
}

/// Such as `n/a` or `#REF!`, which stand in the place of a number. A file without numbers may hold anything in as few characters.
bool like_a_gap(std::string_view cell) { return cell.size() <= 5; }

/// Zeros in bytes that are UTF-8 otherwise: their number, and the line of the first. Nothing where there are none, or where other
/// bytes are no text.
std::optional<std::pair<std::size_t, int>> zeros_in(std::string const& bytes) {
  std::size_t const first = bytes.find('\0');
  if (first == std::string::npos) return std::nullopt;
  std::string text = bytes;
  std::size_t const count = std::erase(text, '\0');
  auto const controls = [](char c) { return static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r'; };
  if (text.empty() || !is_utf8(text) || std::any_of(text.begin(), text.end(), controls)) return std::nullopt;
  Lines line(bytes);
  while (line.next() && line.end < first) {
  }
  return std::pair(count, line.number);
}

/// A quote that does not end and a row that is too short may as well be mistakes of the file: what to do about them stays.
std::string beside_proposal(Diagnostic const& diagnostic) {
  return diagnostic.code == "E4004" || diagnostic.code == "E4005" ? diagnostic.help + "; or " : std::string();
}

}  // namespace

Table Table::read(std::string const& path, std::optional<Span> mention, ReadingRules const& rules) {
  try {
    std::string bytes = read_record_bytes(path);
    if (!is_gzip(bytes)) return parse(path, std::move(bytes), mention, 0, rules);
    Table table = parse(path, gunzip(path, bytes), mention, 0, rules);
    table.digest_ = sha256(bytes);
    return table;
  } catch (UserError const& error) {
    Diagnostic placed = error.diagnostic();
    if (mention && !placed.primary) placed.primary = Label{*mention, {}};
    throw UserError(std::move(placed));
  }
}

Table Table::parse(std::string name, std::string bytes, std::optional<Span> mention, std::int64_t rows_before,
                   ReadingRules const& rules, ColumnNeeds const& needs) {
  Table table;
  table.needs_ = needs;
  table.rows_before_ = rows_before;
  table.name_ = std::move(name);
  table.digest_ = sha256(bytes);
  table.rules_ = rules;
  table.notation_ = {rules.decimal, rules.thousands, rules.missing};
  if (!has_utf16_mark(bytes) && rules.encoding == Encoding::utf8 && !is_utf8(bytes)) {
    auto const proposed = proposed_encoding(bytes, rules, needs);
    if (auto const zeros = proposed ? std::nullopt : zeros_in(bytes))
      throw UserError(data_errors::nul_bytes(table.name_, rows_before + zeros->second, zeros->first, mention));
    throw UserError(data_errors::not_text(table.name_, proposed, mention));
  }
  auto text = to_utf8(std::move(bytes), rules.encoding);
  if (!text)
    throw UserError(data_errors::not_in_encoding(table.name_, rules.encoding == Encoding::latin1 ? "latin1" : "utf16", mention));
  table.bytes_ = std::move(*text);
  try {
    TableParser(table, mention).run();
  } catch (UserError const& error) {
    table.rethrow_with_proposal(error, {});
  }
  return table;
}

Table Table::parse_as_told(std::string name, std::string bytes, ReadingRules const& rules) {
  Table table;
  table.name_ = std::move(name);
  table.rules_ = rules;
  table.notation_ = {rules.decimal, rules.thousands, rules.missing};
  table.bytes_ = std::move(bytes);
  table.proposes_ = false;
  TableParser(table, std::nullopt).run();
  return table;
}

/// What makes a file readable goes in place of what the message would advise. Of a file that is no record nothing is said.
void Table::rethrow_with_proposal(UserError const& error, std::string const& column) const {
  if (!proposes_) throw UserError(error.diagnostic());
  Diagnostic diagnostic = error.diagnostic();
  bool const complete = needs_.whole(column);
  std::string help = proposed_help({bytes_, rules_, needs_, column, diagnostic.code});
  if (!help.empty()) diagnostic.help = beside_proposal(diagnostic) + help;
  if (help.empty() && complete && diagnostic.code == "E4022")
    diagnostic.help =
        "it needs a number in every row: fill the gap in the file, or save the rows before and after it in files of their own; "
        "if it is a sample, add this line to the data block: `read missing = none`";
  else if (!help.empty() && diagnostic.code == "E4022")
    diagnostic.help += "; or, if it is a sample, `read missing = none`";
  throw UserError(std::move(diagnostic));
}

std::int64_t Table::line(int row) const {
  return rows_before_ + (lines_.empty() ? header_line_ + row : lines_[static_cast<std::size_t>(row - 1)]);
}

data_errors::Cell Table::place(std::size_t index, std::string const& column) const {
  int const row = static_cast<int>(index) + 1;
  return {name_, rows_before_ + row, line(row), column};
}

std::string_view Table::cell(int row, int column) const {
  std::size_t const at = static_cast<std::size_t>(row - 1) * (columns_.size() + 1) + static_cast<std::size_t>(column);
  std::size_t const begin = std::min<std::size_t>(cells_[at], bytes_.size());
  return std::string_view(bytes_).substr(begin, cells_[at + 1] - 1 - cells_[at]);
}

std::vector<std::string> Table::texts(int column, int most) const {
  std::vector<std::string> all;
  for (int row = 1; row <= std::min(rows_, most); ++row) all.push_back(unquoted_cell(cell(row, column)));
  return all;
}

bool Table::names_units() const {
  if (rows_ < 2) return false;
  auto const kind = [&](int row, int column) {
    double ignored = 0;
    return parse_cell(cell(row, column), notation_, ignored);
  };
  bool numbers_follow = false;
  for (int column = 0; column < static_cast<int>(columns_.size()); ++column) {
    CellKind const first = kind(1, column);
    if (first != CellKind::text && first != CellKind::missing) return false;
    numbers_follow = numbers_follow || (first == CellKind::text && kind(2, column) == CellKind::number);
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

int Table::index_of(std::string const& column, std::optional<Span> mention) const {
  auto const found = std::find(columns_.begin(), columns_.end(), column);
  if (found == columns_.end() || column.empty())
    throw UserError(data_errors::missing_column(name_, column, columns_, is_record(), mention));
  if (std::find(found + 1, columns_.end(), column) != columns_.end())
    throw UserError(data_errors::repeated_column(name_, column, mention));
  return static_cast<int>(found - columns_.begin());
}

std::optional<std::string> Table::unit(std::string const& column) const {
  auto const found = std::find(columns_.begin(), columns_.end(), column);
  if (units_.empty() || found == columns_.end()) return std::nullopt;
  return units_[static_cast<std::size_t>(found - columns_.begin())];
}

std::vector<double> Table::numbers(std::string const& column, std::optional<Span> mention) const {
  try {
    return numbers_as_told(column, mention);
  } catch (UserError const& error) {
    rethrow_with_proposal(error, column);
  }
}

std::vector<double> Table::times(std::string const& column, std::optional<Span> mention) const {
  try {
    return rules_.stamp.empty() ? numbers_as_told(column, mention) : times_as_told(column, mention);
  } catch (UserError const& error) {
    rethrow_with_proposal(error, column);
  }
}

std::vector<double> Table::numbers_as_told(std::string const& column, std::optional<Span> mention) const {
  int const index = index_of(column, mention);
  std::vector<double> values(static_cast<std::size_t>(rows_));
  bool any = false;  // numbers so far
  for (int row = 1; row <= rows_; ++row) {
    if (row % rows_between_looks == 0) stop_if_interrupted();
    double& value = values[static_cast<std::size_t>(row - 1)];
    std::string_view const text = cell(row, index);
    CellKind const kind = parse_cell(text, notation_, value);
    if (kind == CellKind::number) {
      any = true;
      continue;
    }
    if (kind == CellKind::missing) {
      value = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    data_errors::Cell const where = place(static_cast<std::size_t>(row - 1), column);
    std::string_view const shown = trimmed(text, cell_blanks);
    if (kind == CellKind::text && rows_before_ + row == 1 && names_units())
      throw UserError(data_errors::row_of_units(where, shown, mention));
    // A model of unknown origin may name any file as data: what is no number of a record is not repeated.
    bool const shows = any || like_a_number(shown) || (like_a_gap(shown) && is_record());
    if (kind == CellKind::text && !any && column == needs_.time && read_duration(unquoted_cell(text)))
      throw UserError(data_errors::durations(where, shown, mention));
    if (kind == CellKind::text && any && is_time_stamp(shown))
      throw UserError(data_errors::stamp_among_numbers(where, shown, mention));
    throw UserError(kind == CellKind::not_finite     ? data_errors::not_finite(where, shown, mention)
                    : kind == CellKind::out_of_range ? data_errors::out_of_range(where, shown, mention)
                                                     : data_errors::not_a_number(where, shown, shows, mention));
  }
  refuse_doubtful_points(index, mention);
  if (!rules_.asked_for_missing)
    if (auto const doubtful = doubtful_numbers(values); !doubtful.empty())
      throw UserError(data_errors::doubtful_sample(place(doubtful.front().places.front(), column),
                                                   text_of_number(doubtful.front().value, notation_),
                                                   static_cast<int>(doubtful.front().places.size()), mention));
  return values;
}

int Table::row_of_doubtful_points(int column) const {
  if (rules_.decimal_given || rules_.thousands != 0) return 0;
  if (separator_ == ',' && bytes_.find('"') == std::string::npos) return 0;  // no other cell has a decimal comma
  int points = 0, whole = 0, first = 0;
  for (int row = 1; row <= rows_; ++row) {
    NotationEvidence const evidence = notation_of(cell(row, column));
    if (evidence.decimal != 0) return 0;
    points += evidence.either == '.';
    whole += evidence.plain_digits;
    if (evidence.either == '.' && first == 0) first = row;
  }
  if (points == 0 || whole == 0) return 0;
  constexpr int many = 3;  // then nothing but the column itself decides
  if (points >= many && separator_ != ',') return first;
  // Of fewer, what other columns have: `0.25` decides for points, `0,25` for groups; between commas
  // there are points.
  bool comma = false;
  for (int row = 1; row <= rows_; ++row)
    for (int other = 0; other < static_cast<int>(columns_.size()); ++other) {
      NotationEvidence const evidence = notation_of(cell(row, other));
      if (evidence.number && evidence.decimal == '.') return 0;
      comma = comma || (evidence.number && (evidence.decimal == ',' || evidence.either == ','));
    }
  return separator_ != ',' || comma ? first : 0;
}

void Table::refuse_doubtful_points(int column, std::optional<Span> mention) const {
  int const row = row_of_doubtful_points(column);
  if (row == 0) return;
  std::string const& name = columns_[static_cast<std::size_t>(column)];
  throw UserError(
      data_errors::points_or_groups(place(static_cast<std::size_t>(row - 1), name), unquoted_cell(cell(row, column)), mention));
}

std::vector<double> Table::serial_times_as_told(std::string const& column, SerialTime const* unit,
                                                std::optional<Span> mention) const {
  int const index = index_of(column, mention);
  std::vector<SerialStamp> stamps;
  for (int row = 1; row <= rows_; ++row) {
    if (row % rows_between_looks == 0) stop_if_interrupted();
    std::string const text = unquoted_cell(cell(row, index));
    auto const read = unit != nullptr ? read_serial(text, *unit, notation_) : read_duration(text, notation_);
    if (!read)
      throw UserError(data_errors::not_a_stamp(place(static_cast<std::size_t>(row - 1), column), row > 1 ? text : std::string(),
                                               rules_.stamp, mention));
    stamps.push_back(*read);
  }
  refuse_doubtful_points(index, mention);
  return seconds_of(stamps, unit != nullptr ? *unit : *find_serial_time("seconds"));
}

std::vector<double> Table::times_as_told(std::string const& column, std::optional<Span> mention) const {
  SerialTime const* const unit = find_serial_time(rules_.stamp);
  if (unit != nullptr || rules_.stamp == duration_word) return serial_times_as_told(column, unit, mention);
  auto const pattern = StampPattern::parse(rules_.stamp);
  if (!pattern) throw InternalError("a stamp that is no pattern");
  int const index = index_of(column, mention), date = rules_.date.empty() ? -1 : index_of(rules_.date, mention);
  std::int64_t const turn = pattern->turn();
  std::vector<double> seconds(static_cast<std::size_t>(rows_));
  TimeStamp first, before;
  std::int64_t turns = 0;
  bool elapsed = false;
  for (int row = 1; row <= rows_; ++row) {
    if (row % rows_between_looks == 0) stop_if_interrupted();
    std::string text = unquoted_cell(cell(row, index));
    if (date >= 0) text = unquoted_cell(cell(row, date)) + " " + text;
    auto stamp = pattern->read(text);
    if (!stamp) {
      bool const shows = is_time_stamp(text) || row > 1;
      throw UserError(data_errors::not_a_stamp(place(static_cast<std::size_t>(row - 1), column), shows ? text : std::string(),
                                               rules_.stamp, mention));
    }
    if (row == 1) first = *stamp;
    if (stamp->has_zone != first.has_zone)
      throw UserError(data_errors::zones_differ(place(static_cast<std::size_t>(row - 1), column), text, stamp->has_zone, mention));
    if (pattern->has_counted_fraction() && stamp->decimals != first.decimals)
      throw UserError(data_errors::fractions_differ(place(static_cast<std::size_t>(row - 1), column), text, mention));
    // Time of day that falls by more than half a day has passed midnight, minutes and seconds that fall by half an hour the hour.
    // Elapsed times that have gone beyond a day, or an hour, do not begin again.
    elapsed = elapsed || (!pattern->has_date() && stamp->second > turn);
    if (!pattern->has_date() && !elapsed && row > 1 && before.second - (stamp->second + turns * turn) > turn / 2) ++turns;
    stamp->second += turns * turn;
    before = *stamp;
    seconds[static_cast<std::size_t>(row - 1)] = seconds_between(first, *stamp);
  }
  return seconds;
}

}  // namespace sysid
