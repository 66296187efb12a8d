// Times: the pattern of the dates and times in a column, and the column with the date beside a time of day.
#include <algorithm>
#include <optional>

#include "data/cell/serial_time.hpp"
#include "data/cell/time_stamp.hpp"
#include "data/cell/usual_stamps.hpp"
#include "data/table/proposal_steps.hpp"

namespace sysid {
namespace {

std::vector<std::string> filled_cells(Layout const& layout, std::size_t column) {
  std::vector<std::string> cells;
  for (std::vector<std::string> const& row : layout.rows)
    if (!row[column].empty()) cells.push_back(row[column]);
  return cells;
}

/// Whether the same stamp stands in rows that follow each other: a date beside a time of day.
bool is_date(std::vector<std::string> const& cells) {
  auto const patterns = patterns_of(cells);
  return !patterns.empty() && cells.front().find(':') == std::string::npos;
}
bool is_time_of_day(std::vector<std::string> const& cells) {
  auto const patterns = patterns_of(cells);
  if (patterns.empty()) return false;
  auto const pattern = StampPattern::parse(patterns.front());
  return pattern && !pattern->has_date();
}

std::optional<std::size_t> index_of(Layout const& layout, std::string const& column) {
  auto const found = std::find(layout.columns.begin(), layout.columns.end(), column);
  if (found == layout.columns.end()) return std::nullopt;
  return static_cast<std::size_t>(found - layout.columns.begin());
}

bool are_durations(std::vector<std::string> const& cells, ReadingRules const& rules) {
  NumberNotation const notation{rules.decimal, rules.thousands};
  return !cells.empty() && std::all_of(cells.begin(), cells.end(),
                                       [&](std::string const& cell) { return read_duration(cell, notation).has_value(); });
}

}  // namespace

void add_stamps(Layout const& layout, std::string const& wanted, Proposal& proposal, Alternatives& all) {
  if (wanted.empty() || !all.rules.front().stamp.empty()) return;
  auto column = index_of(layout, wanted);
  if (column && layout.looks[*column] == CellLook::text && are_durations(filled_cells(layout, *column), all.rules.front())) {
    for (ReadingRules& rules : all.rules) rules.stamp = duration_word;
    return;
  }
  if (!column || layout.looks[*column] != CellLook::stamp) return;
  std::vector<std::string> cells = filled_cells(layout, *column);
  std::optional<std::size_t> date;
  for (std::size_t c = 0; c < layout.columns.size(); ++c) {
    if (c == *column || layout.looks[c] != CellLook::stamp || layout.columns[c].empty()) continue;
    std::vector<std::string> const others = filled_cells(layout, c);
    if (others.size() != cells.size()) continue;
    if (is_date(cells) && is_time_of_day(others)) {  // the other way about: the time of day is the time
      proposal.time = layout.columns[c];
      date = column;
      column = c;
      cells = others;
      break;
    }
    if (is_time_of_day(cells) && is_date(others)) {
      date = c;
      break;
    }
  }
  if (date) {
    std::vector<std::string> const dates = filled_cells(layout, *date);
    for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = dates[i] + " " + cells[i];
  }
  std::vector<std::string> const patterns = patterns_of(cells, layout.columns[*column]);
  if (patterns.empty()) return;
  std::vector<ReadingRules> made;
  for (ReadingRules const& rules : all.rules)
    for (std::string const& pattern : patterns) {
      made.push_back(rules);
      made.back().stamp = pattern;
      if (date) made.back().date = layout.columns[*date];
    }
  if (patterns.size() > 1) all.question += (all.question.empty() ? "" : "; ") + question_of(patterns, cells);
  all.rules = std::move(made);
}

}  // namespace sysid
