// Layouts: which lines hold names, units and values, and the notation of numbers.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/text/words.hpp"
#include "data/cell/cells.hpp"
#include "data/cell/number_notation.hpp"
#include "data/table/proposal_steps.hpp"

namespace sysid {
namespace {

/// The line of the names that is taken when nothing is said, and the separator found there.
struct Unsaid {
  int names = 0;
  char separator = ',';
};
Unsaid unsaid(std::string const& bytes) {
  Lines line(bytes);
  char stated = 0;
  while (line.next()) {
    std::string_view const bare = trimmed(line.text(), cell_blanks);
    if (auto const separator = stated_separator(line.text()); separator && line.number == 1) {
      stated = separator->front();
      continue;
    }
    if (!bare.empty() && !bare.starts_with('#')) return {line.number, stated != 0 ? stated : find_separator(line.text())};
  }
  return {};
}

/// Else the first line is taken for names where `values` does not say otherwise.
bool all_are_numbers(std::vector<std::string> const& row) {
  return std::all_of(row.begin(), row.end(), [](std::string const& cell) { return look_of(cell) == CellLook::number; });
}

}  // namespace

void add_lines(std::string const& bytes, Layout const& layout, ReadingRules& rules) {
  Unsaid const plain = unsaid(bytes);
  std::set<std::string> const distinct(layout.columns.begin(), layout.columns.end());
  bool const short_names = layout.names == 0;
  if (rules.names == 0 && layout.names != plain.names) rules.names = layout.names;
  if (rules.units == UnitsPlace::none && layout.units != 0) {
    rules.units = UnitsPlace::line;
    rules.units_line = layout.units;
  }
  int const above = std::max(layout.names, layout.units);
  if (rules.first_value == 0 && (layout.first != above + 1 || short_names || (layout.more_below && layout.last != 0)))
    if (!(short_names && layout.first == 1 && all_are_numbers(layout.rows.front()))) rules.first_value = layout.first;
  if (layout.more_below && layout.last != 0 && rules.last_value == 0) {
    rules.first_value = layout.first;
    rules.last_value = layout.last;
  }
  char const found = layout.names != 0 && layout.names != plain.names ? 0 : plain.separator;
  if (rules.separator == 0 && (found != layout.separator && layout.columns.size() > 1)) {
    Lines line(bytes);
    int const names = layout.names != 0 ? layout.names : layout.first;
    while (line.number < names && line.next()) {
    }
    if (find_separator(line.text()) != layout.separator || (found != 0 && found != layout.separator))
      rules.separator = layout.separator;
  }
  if (layout.ragged) rules.ragged = true;
  if (layout.comments != 0) rules.comments = layout.comments;
  if (rules.columns.empty() && short_names) rules.columns = layout.columns;
}

void add_notation(Layout const& layout, Alternatives& all) {
  std::set<char> decimals, thousands, either;
  std::string doubtful;
  each_cell_of_numbers(layout, [&](std::string const& cell) {
    NotationEvidence const evidence = notation_of(cell);
    if (evidence.decimal != 0) decimals.insert(evidence.decimal);
    if (evidence.thousands != 0) thousands.insert(evidence.thousands);
    if (evidence.either != 0) either.insert(evidence.either), doubtful = cell;
  });
  if (decimals.size() > 1 || thousands.size() > 1) return;  // no file is written so
  ReadingRules& rules = all.rules.front();
  if (rules.decimal_given || rules.thousands != 0) {
    // The block says one of the two; the other follows.
    if (!thousands.empty() && rules.thousands == 0) rules.thousands = *thousands.begin();
    for (char const sign : either)
      if (sign != rules.decimal && rules.thousands == 0) rules.thousands = sign;
    if (rules.thousands == rules.decimal) rules.decimal = rules.decimal == '.' ? ',' : '.', rules.decimal_given = true;
    return;
  }
  if (!thousands.empty()) rules.thousands = *thousands.begin();
  char decimal = decimals.empty() ? 0 : *decimals.begin();
  if (decimal == 0 && (rules.thousands == '.' || rules.thousands == ',')) decimal = rules.thousands == '.' ? ',' : '.';
  if (decimal != 0) {
    rules.decimal = decimal;
    rules.decimal_given = decimal == ',';
    for (char const sign : either)
      if (sign != decimal) rules.thousands = sign;
    return;
  }
  if (either.size() == 1 && *either.begin() == ',') {
    ReadingRules grouped = rules;
    rules.decimal = ',';
    rules.decimal_given = true;
    grouped.thousands = ',';
    all.rules.push_back(grouped);
    std::string plain = doubtful;
    std::replace(plain.begin(), plain.end(), ',', '.');
    std::string without = doubtful;
    std::erase(without, ',');
    all.question = fmt::format("`{}` may be {} or {}", doubtful, plain, without);
  }
}

}  // namespace sysid
