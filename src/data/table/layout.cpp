// The lines are cut at each separator in turn; the one that makes most numbers in lines that look alike is taken.
#include "data/table/layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "core/system/interrupt.hpp"
#include "core/text/words.hpp"
#include "data/cell/cells.hpp"
#include "data/cell/number_notation.hpp"
#include "data/cell/time_stamp.hpp"
#include "data/cell/unit_text.hpp"

namespace sysid {
namespace {

constexpr int most_lines = 20000;  // that are looked at
constexpr std::string_view comment_signs = "#%!/;*$@";

using Cells = std::vector<std::string>;

std::vector<std::string> first_lines(std::string const& bytes, bool& all) {
  std::vector<std::string> lines;
  Lines line(bytes);
  while (static_cast<int>(lines.size()) < most_lines && line.next()) lines.emplace_back(line.text());
  all = !line.next();
  return lines;
}

/// Empty for a line that cannot be cut so.
Cells cells_of(std::string const& line, char separator) {
  Cells cells;
  if (trimmed(line, cell_blanks).empty()) return cells;
  if (!split_cells(line, 0, line.size(), separator, [&](std::size_t begin, std::size_t end) {
        cells.push_back(unquoted_cell(std::string_view(line).substr(begin, end - begin)));
      }))
    cells.clear();
  return cells;
}

/// `---- ----` or `|---|---|` between the names and the values.
bool is_ruled(std::string const& line) {
  return line.find("--") != std::string::npos && line.find_first_not_of("|+-=: \t\r") == std::string::npos;
}

/// Comments that may hold names and units.
bool begins_named_comment(std::string const& line) {
  std::string_view const bare = trimmed(line, cell_blanks);
  return !bare.empty() && (bare.front() == '#' || bare.front() == '%');
}

bool begins_comment(std::string const& line) {
  std::string_view const bare = trimmed(line, cell_blanks);
  return !bare.empty() && comment_signs.find(bare.front()) != std::string_view::npos;
}

class Cut {
 public:
  Cut(std::vector<std::string> const& lines, char separator) : lines_(lines), separator_(separator) {
    for (std::string const& line : lines) {
      cells_.push_back(cells_of(line, separator));
      std::vector<CellLook>& looks = looks_.emplace_back();
      for (std::string const& cell : cells_.back()) looks.push_back(look_of(cell));
    }
    find_columns();
    find_rows();
  }

  /// Numbers in the rows.
  long score() const {
    return static_cast<long>(end_ - begin_) * std::count_if(column_looks_.begin(), column_looks_.end(), [](CellLook look) {
             return look == CellLook::number || look == CellLook::stamp;
           });
  }
  std::size_t width() const { return width_; }

  /// all: these are all lines of the file. open: its last one has no end.
  Layout layout(bool all, bool open) const {
    Layout layout;
    std::size_t const end = all && open && ends_within_row() ? end_ - 1 : end_;
    layout.separator = separator_;
    layout.first = static_cast<int>(begin_) + 1;
    layout.last = all ? static_cast<int>(end) : 0;
    layout.looks = column_looks_;
    std::size_t below = end;
    while (below < lines_.size() && trimmed(lines_[below]).empty()) ++below;
    layout.more_below = below < lines_.size();
    layout.broken = broken_line();
    find_names(layout);
    std::size_t const wide = layout.columns.size();
    for (std::size_t i = begin_; i < end; ++i) {
      if (cells_[i].empty() || !is_row(i)) {
        if (begins_comment(lines_[i])) layout.comments = trimmed(lines_[i], cell_blanks).front();
        continue;
      }
      layout.ragged = layout.ragged || cells_[i].size() != wide;
      Cells row = cells_[i];
      row.resize(wide);
      layout.rows.push_back(std::move(row));
    }
    layout.looks.resize(wide, CellLook::empty);
    return layout;
  }

 private:
  /// Whether the last line of the file is the only row that lacks cells.
  bool ends_within_row() const {
    if (end_ != lines_.size() || cells_[end_ - 1].size() >= width_) return false;
    for (std::size_t i = begin_; i + 1 < end_; ++i)
      if (is_row(i) && cells_[i].size() < width_) return false;
    return true;
  }
  bool holds_numbers(std::size_t i) const {
    std::vector<CellLook> const& looks = looks_[i];
    auto const is = [&](CellLook look) { return std::count(looks.begin(), looks.end(), look); };
    return is(CellLook::number) + is(CellLook::stamp) > 0 && is(CellLook::text) * 2 <= static_cast<long>(looks.size());
  }
  /// The usual number of cells, and what most of them look like.
  void find_columns() {
    // By their numbers: settings above a table, `Sample rate;1000`, may be more lines than a short record.
    std::map<std::size_t, long> widths;
    for (std::size_t i = 0; i < lines_.size(); ++i)
      if (holds_numbers(i)) widths[cells_[i].size()] += std::count(looks_[i].begin(), looks_[i].end(), CellLook::number);
    long most = -1;
    for (auto const& [width, count] : widths)
      if (count > most) most = count, width_ = width;
    for (std::size_t column = 0; column < width_; ++column) {
      std::array<int, 5> counts{};
      for (std::size_t i = 0; i < lines_.size(); ++i)
        if (holds_numbers(i) && cells_[i].size() == width_) ++counts[static_cast<std::size_t>(looks_[i][column])];
      CellLook look = CellLook::empty;
      int best = 0;
      for (CellLook const each : {CellLook::number, CellLook::stamp, CellLook::text})
        if (counts[static_cast<std::size_t>(each)] > best) best = counts[static_cast<std::size_t>(each)], look = each;
      column_looks_.push_back(look);
    }
    // Separators at the ends of lines make a column of nothing.
    while (width_ > 1 && column_looks_.back() == CellLook::empty && trailing()) --width_, column_looks_.pop_back();
  }
  /// Whether the last column is empty and has no name above.
  bool trailing() const {
    for (std::size_t i = 0; i < lines_.size(); ++i)
      if (cells_[i].size() == width_ && !cells_[i].back().empty()) return false;
    return true;
  }
  bool is_row(std::size_t i) const {
    std::vector<CellLook> const& looks = looks_[i];
    if (looks.empty() || looks.size() + 1 < width_ || (looks.size() < width_ && looks.size() < 2)) return false;
    bool any = false;
    for (std::size_t c = 0; c < looks.size(); ++c) {
      if (c >= width_) {
        if (looks[c] != CellLook::empty) return false;
        continue;
      }
      CellLook const wanted = column_looks_[c], look = looks[c];
      any = any || look == CellLook::number || look == CellLook::stamp;
      if (wanted == CellLook::text || look == wanted || look == CellLook::empty || look == CellLook::gap) continue;
      if (wanted == CellLook::empty) continue;
      // A short word among numbers: what stands there is asked about where it is read.
      if (look == CellLook::text && wanted == CellLook::number && c > 0 && any) continue;
      return false;
    }
    return any;
  }
  /// The longest run of rows; empty lines and comments may stand between them.
  void find_rows() {
    std::size_t begin = 0, count = 0, best = 0, end = 0;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      if (is_row(i)) {
        if (count++ == 0) begin = i;
        end = i + 1;
        if (count > best) best = count, begin_ = begin, end_ = end;
      } else if (!(trimmed(lines_[i]).empty() || begins_comment(lines_[i]))) {
        count = 0;
      }
    }
  }

  /// Where names, rows, one line that is none, and the longest run follow each other: that line, from 1.
  int only_broken_line_above() const {
    std::size_t first = 0;
    while (first < begin_ && !(is_row(first) && looks_[first].size() == width_)) ++first;
    if (first == 0 || first >= begin_ || heading(first - 1, false).empty()) return 0;
    int line = 0;
    for (std::size_t i = first; i < begin_; ++i) {
      if (is_row(i) || trimmed(lines_[i]).empty()) continue;
      if (line != 0 || cells_[i].size() != width_ || !heading(i, false).empty()) return 0;
      line = static_cast<int>(i) + 1;
    }
    return line;
  }
  /// The line that ends the longest run of rows and has rows below it, or stands before it and has some above; counted from 1. What
  /// stands above a table has few lines that look like its rows.
  int broken_line() const {
    constexpr long enough = 3;
    for (std::size_t i = end_; i < lines_.size(); ++i)
      if (is_row(i)) {
        std::size_t line = end_;
        while (trimmed(lines_[line]).empty()) ++line;
        return static_cast<int>(line) + 1;
      }
    if (int const line = only_broken_line_above()) return line;
    long above = 0;
    for (std::size_t i = 0; i < begin_; ++i) above += is_row(i) && looks_[i].size() == width_;
    if (above < enough || width_ < 2) return 0;
    std::size_t line = begin_;
    while (line > 0 && (is_row(line - 1) || trimmed(lines_[line - 1]).empty())) --line;
    return static_cast<int>(line);
  }

  /// The cells of a line above the rows that may name columns; empty where it does not. above_units: names may be numbers there.
  Cells heading(std::size_t i, bool above_units) const {
    std::string line = lines_[i];
    Cells cells = cells_[i];
    if (begins_named_comment(line)) {
      line = line.substr(line.find_first_of("#%") + 1);
      cells = cells_of(line, separator_);
    }
    while (cells.size() > width_ && cells.back().empty()) cells.pop_back();
    if (cells.size() < width_ || cells.size() > width_ + 1) return {};
    bool any_text = false;
    for (std::string const& cell : cells) {
      CellLook const look = look_of(cell);
      if ((look == CellLook::number && !(above_units && any_text)) || look == CellLook::stamp) return {};
      any_text = any_text || look == CellLook::text;
    }
    return any_text ? cells : Cells{};
  }
  void find_names(Layout& layout) const {
    constexpr std::size_t most_headings = 6;
    std::vector<std::pair<std::size_t, Cells>> headings;  // from below
    for (std::size_t i = begin_; i-- > 0 && headings.size() < most_headings;) {
      if (trimmed(lines_[i]).empty() || is_ruled(lines_[i])) continue;
      bool const comment = trimmed(lines_[i], cell_blanks).starts_with('#');
      if (comment && !headings.empty()) break;
      // Above names that are no comment, a comment is a remark: `% t in s`.
      if (!headings.empty() && begins_named_comment(lines_[i]) && !begins_named_comment(lines_[headings.back().first])) break;
      Cells cells =
          heading(i, !headings.empty() && (are_units(headings.back().second, false) || holds_settings(headings.back().second)));
      if (cells.empty()) break;
      headings.emplace_back(i, std::move(cells));
    }
    std::size_t chosen = headings.size();
    for (std::size_t h = 0; h + 1 < headings.size() && chosen == headings.size(); ++h)
      if (are_units(headings[h].second, begins_comment(lines_[headings[h].first]))) {
        layout.units = static_cast<int>(headings[h].first) + 1;
        chosen = h + 1;
        // Lines of settings may stand between the names and the units: `wf_increment 0.01 0.01`.
        for (std::size_t above = headings.size(); above-- > h + 1;)
          if (!holds_settings(headings[above].second)) chosen = above;
      }
    for (std::size_t h = 0; h < headings.size() && chosen == headings.size(); ++h) {
      Cells const& cells = headings[h].second;
      std::set<std::string> const distinct(cells.begin(), cells.end());
      if (distinct.size() == cells.size()) chosen = h;  // a column of row numbers may have no name
    }
    if (chosen == headings.size() && !headings.empty()) chosen = 0;
    if (chosen < headings.size()) {
      layout.names = static_cast<int>(headings[chosen].first) + 1;
      layout.columns = headings[chosen].second;
      Cells const& written = cells_[headings[chosen].first];
      layout.ragged = layout.ragged || (written.size() > width_ && written.back().empty());
      return;
    }
    for (std::size_t c = 0; c < width_; ++c) layout.columns.push_back(fmt::format("column_{}", c + 1));
  }
  /// Numbers that name no channels: they have decimals, or one is there twice.
  static bool holds_settings(Cells const& cells) {
    std::set<std::string> numbers;
    for (std::string const& cell : cells) {
      if (look_of(cell) != CellLook::number) continue;
      if (cell.find_first_of(".,") != std::string::npos || !numbers.insert(cell).second) return true;
    }
    return false;
  }
  /// all: each of them; else half of them are enough.
  static bool are_units(Cells const& cells, bool all) {
    long filled = 0, units = 0;
    for (std::string const& cell : cells) {
      filled += !cell.empty();
      units += unit_of_text(cell).has_value();
    }
    return filled > 0 && (all ? units == filled : units * 2 >= filled);
  }

  std::vector<std::string> const& lines_;
  char separator_;
  std::vector<Cells> cells_;
  std::vector<std::vector<CellLook>> looks_;
  std::size_t width_ = 0, begin_ = 0, end_ = 0;
  std::vector<CellLook> column_looks_;
};

}  // namespace

CellLook look_of(std::string_view cell) {
  if (cell.empty()) return CellLook::empty;
  if (notation_of(cell).number) return CellLook::number;
  if (is_time_stamp(cell)) return CellLook::stamp;
  static constexpr std::string_view gaps[] = {
      "nan",     "-nan",   "+nan",    "na",    "n/a",    "#n/a",    "#nv",     "null", "none", "nil",  "-",     "--",
      "---",     "inf",    "-inf",    "+inf",  "bad",    "err",     "error",   "ovf",  "ovl",  "over", "under", "invalid",
      "1.#qnan", "1.#ind", "-1.#ind", "#ref!", "#wert!", "#value!", "#div/0!", "∞",    "-∞",   "+∞",   "?",     "*"};
  std::string const small = in_small_letters(cell);
  return std::find(std::begin(gaps), std::end(gaps), small) == std::end(gaps) ? CellLook::text : CellLook::gap;
}

std::optional<Layout> find_layout(std::string const& bytes) {
  bool all = true;
  std::vector<std::string> const lines = first_lines(bytes, all);
  std::optional<Layout> best;
  long best_score = 0;
  std::size_t best_width = 0;
  for (char const separator : {'\t', ';', ',', '|', ' '}) {
    stop_if_interrupted();
    Cut const cut(lines, separator);
    bool const wider = best_width < 2 && cut.width() > 1 && cut.score() > 0;
    if (cut.score() > best_score || wider) {
      if (best_width > 1 && cut.width() < 2) continue;
      best_score = cut.score();
      best_width = cut.width();
      best = cut.layout(all, !bytes.ends_with('\n') && !bytes.ends_with('\r'));
    }
  }
  return best;
}

}  // namespace sysid
