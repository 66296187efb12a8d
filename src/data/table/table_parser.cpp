// From lines to the places of cells, by the rules of the data block.
#include "data/table/table_parser.hpp"

#include <algorithm>
#include <limits>

#include "core/system/interrupt.hpp"
#include "data/cell/cells.hpp"
#include "data/cell/unit_text.hpp"
#include "data/table/file_errors.hpp"

namespace sysid {
namespace {

constexpr int lines_between_looks = 1 << 16;  // rows between two looks at the signals

bool all_numbers(std::vector<std::string> const& names, NumberNotation const& notation) {
  return std::all_of(names.begin(), names.end(), [&](std::string const& name) {
    double ignored = 0;
    return parse_cell(name, notation, ignored) != CellKind::text;
  });
}

}  // namespace

/// The lines with values, one after the other.
class TableParser::Rows {
 public:
  explicit Rows(TableParser& parser) : parser_(parser), table_(parser.table_), columns_(static_cast<int>(table_.columns_.size())) {}

  void line(Lines const& line) {
    std::string_view const text = line.text(), bare = trimmed(text, cell_blanks);
    if (parser_.separator_ == '\t' ? text.find_first_not_of(' ') == std::string_view::npos : bare.empty()) {
      ++empty_lines_;
      return;
    }
    ReadingRules const& rules = table_.rules_;
    if (rules.comments != 0 && bare.starts_with(rules.comments)) {
      skipped_ = true;
      return;
    }
    for (; empty_lines_ > 0; --empty_lines_)
      if (!rules.ragged) row(line.begin, line.begin, line.number - empty_lines_);
    if (bare.starts_with('#'))
      throw UserError(data_errors::comment_in_data(table_.name_, table_.rows_before_ + table_.rows_ + 1,
                                                   table_.rows_before_ + line.number, parser_.mention_));
    row(line.begin, line.end, line.number);
  }
  /// What lines were left out between rows, and so is their numbering.
  void finish() {
    if (!skipped_ && table_.rules_.first_value == 0 && !table_.rules_.ragged && parser_.first_value_ == table_.header_line_ + 1)
      std::vector<int>().swap(table_.lines_);
  }

 private:
  void row(std::size_t begin, std::size_t end, int number) {
    if (table_.rows_ == std::numeric_limits<int>::max())
      throw UserError(data_errors::too_many_rows(table_.name_, table_.rows_, parser_.mention_));
    if (++table_.rows_ % lines_between_looks == 0) stop_if_interrupted();
    int cells = 0;
    bool filled = false;  // a cell beyond the last column
    std::size_t last_end = begin;
    bool const closed =
        split_cells(table_.bytes_, begin, end, parser_.separator_, [&](std::size_t cell_begin, std::size_t cell_end) {
          if (++cells <= columns_) {
            table_.cells_.push_back(cell_begin);
            last_end = cell_end;
          } else {
            filled =
                filled || !trimmed(std::string_view(table_.bytes_).substr(cell_begin, cell_end - cell_begin), cell_blanks).empty();
          }
        });
    std::int64_t const before = table_.rows_before_;
    if (!closed) throw UserError(data_errors::open_quote(table_.name_, before + number, parser_.mention_));
    bool const cut = cells < columns_ && columns_ > 1 && end == table_.bytes_.size() && before == 0 && table_.rows_ > 1;
    if (cut && !table_.rules_.ragged)
      throw UserError(data_errors::cut_row(table_.name_, table_.rows_, number, cells, columns_, parser_.mention_));
    if (cells != columns_ && (!table_.rules_.ragged || filled))
      throw UserError(
          data_errors::ragged_row(table_.name_, before + table_.rows_, before + number, cells, columns_, parser_.mention_));
    for (; cells < columns_; ++cells) table_.cells_.push_back(++last_end);  // empty ones
    table_.cells_.push_back(last_end + 1);
    table_.lines_.push_back(number);
  }

  TableParser& parser_;
  Table& table_;
  int columns_;
  int empty_lines_ = 0;  // not rows when they end the file
  bool skipped_ = false;
};

bool TableParser::is_comment(std::string_view bare) const {
  return bare.front() == '#' || (table_.rules_.comments != 0 && bare.front() == table_.rules_.comments);
}

void TableParser::run() {
  find_names();
  ReadingRules const& rules = table_.rules_;
  Lines line(table_.bytes_);
  while (line.number + 1 < first_value_ && line.next())
    if (rules.units == UnitsPlace::line && line.number == rules.units_line) take_units(line.begin, line.end, line.number);
  if (rules.units == UnitsPlace::names) {
    for (std::string& column : table_.columns_) {
      auto const split = split_name(column);
      table_.units_.push_back(split ? split->unit : std::string());
      if (split) column = split->name;
    }
  }
  if (rules.units == UnitsPlace::line && table_.units_.empty())
    throw UserError(data_errors::no_such_line(table_.name_, "units", rules.units_line, line.number, mention_));
  Rows rows(*this);
  while (line.next() && (rules.last_value == 0 || line.number <= rules.last_value)) rows.line(line);
  rows.finish();
}

void TableParser::find_names() {
  ReadingRules const& rules = table_.rules_;
  Lines line(table_.bytes_);
  char stated = rules.separator;  // 0: not yet
  bool found = false;
  while (!found && line.next()) {
    std::string_view const bare = trimmed(line.text(), cell_blanks);
    if (auto const separator = stated_separator(line.text()); separator && line.number == 1 && rules.names != 1) {
      if (stated == 0 && std::string_view(",;\t").find(separator->front()) == std::string_view::npos)
        throw UserError(data_errors::unknown_separator(table_.name_, line.number, *separator, mention_));
      if (stated == 0) stated = separator->front();
      continue;
    }
    if (rules.names != 0) {
      found = line.number == rules.names;
      continue;
    }
    if (!rules.columns.empty() && rules.first_value != 0) {  // the lines above need not name anything
      found = line.number == rules.first_value;
      continue;
    }
    if (bare.starts_with('#')) table_.comments_.emplace_back(trimmed(bare.substr(1), cell_blanks));
    found = !bare.empty() && !is_comment(bare);
  }
  if (!found && rules.names != 0)
    throw UserError(data_errors::no_such_line(table_.name_, "names", rules.names, line.number, mention_));
  if (!found) throw UserError(data_errors::no_header(table_.name_, mention_));
  separator_ = table_.separator_ = stated != 0 ? stated : find_separator(line.text());
  std::size_t begin = line.begin;
  // `# t force y`: names behind the sign of a comment, as NumPy and gnuplot write them.
  if (std::size_t const first = line.text().find_first_not_of(cell_blanks);
      rules.names != 0 && first != std::string_view::npos && (line.text()[first] == '#' || line.text()[first] == '%'))
    begin += first + 1;
  take_names(begin, line.end, line.number);
}

void TableParser::take_names(std::size_t begin, std::size_t end, int line) {
  ReadingRules const& rules = table_.rules_;
  bool const closed = split_cells(table_.bytes_, begin, end, separator_, [&](std::size_t cell_begin, std::size_t cell_end) {
    table_.columns_.push_back(unquoted_cell(std::string_view(table_.bytes_).substr(cell_begin, cell_end - cell_begin)));
  });
  if (!closed) throw UserError(data_errors::open_quote(table_.name_, line, mention_));
  bool const numbers = all_numbers(table_.columns_, table_.notation_);
  bool const has_names = rules.columns.empty() || rules.names != 0 || (rules.first_value == 0 && !numbers);
  names_line_ = has_names ? line : 0;
  table_.header_line_ = has_names ? line : line - 1;
  if (numbers && rules.columns.empty() && rules.names == 0)
    throw UserError(data_errors::header_of_numbers(table_.name_, line, !table_.comments_.empty(), mention_));
  name_columns(line);
  int const units = rules.units == UnitsPlace::line ? rules.units_line : 0;
  first_value_ = rules.first_value != 0 ? rules.first_value : std::max(table_.header_line_, units) + 1;
}

void TableParser::name_columns(int line) {
  std::vector<std::string> const& given = table_.rules_.columns;
  if (given.empty()) return;
  std::size_t cells = table_.columns_.size();
  // A separator at the end of the line of names, as of all lines.
  if (cells == given.size() + 1 && table_.columns_.back().empty() && table_.rules_.ragged) --cells;
  if (cells != given.size())
    throw UserError(data_errors::other_number_of_columns(table_.name_, line, static_cast<int>(cells),
                                                         static_cast<int>(given.size()), mention_));
  table_.columns_ = given;
}

void TableParser::take_units(std::size_t begin, std::size_t end, int line) {
  bool const closed = split_cells(table_.bytes_, begin, end, separator_, [&](std::size_t cell_begin, std::size_t cell_end) {
    table_.units_.push_back(unquoted_cell(std::string_view(table_.bytes_).substr(cell_begin, cell_end - cell_begin)));
  });
  if (!closed) throw UserError(data_errors::open_quote(table_.name_, line, mention_));
  table_.units_.resize(table_.columns_.size());
}

}  // namespace sysid
