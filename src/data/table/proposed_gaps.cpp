// Gaps: words and numbers that stand for a missing sample.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text/diagnostic.hpp"
#include "data/cell/doubtful_number.hpp"
#include "data/cell/number_notation.hpp"
#include "data/table/proposal_steps.hpp"
#include "data/table/table.hpp"

namespace sysid {
namespace {

/// Words without digits, `OVLD`, in at most a quarter of the cells.
std::vector<std::string> few_words(std::vector<std::string> const& cells) {
  constexpr std::size_t longest = 16, share = 4;
  std::vector<std::string> words;
  for (std::string const& cell : cells)
    if (!cell.empty() && cell != "NA" && cell.size() <= longest && cell.find_first_of("0123456789") == std::string::npos)
      words.push_back(cell);
  if (words.size() * share > cells.size()) return {};
  std::sort(words.begin(), words.end());
  words.erase(std::unique(words.begin(), words.end()), words.end());
  return words;
}

}  // namespace

void add_missing(Layout const& layout, ReadingRules& rules) {
  constexpr std::size_t most_words = 6;
  std::vector<std::string> words = rules.missing;
  auto const add = [&](std::string const& word) {
    if (std::find(words.begin(), words.end(), word) == words.end() && words.size() < most_words) words.push_back(word);
  };
  each_cell_of_numbers(layout, [&](std::string const& cell) {
    if (look_of(cell) == CellLook::gap && cell != "NA") add(cell);
  });
  for (std::size_t c = 0; c < layout.columns.size(); ++c) {
    if (layout.looks[c] != CellLook::number) continue;
    std::vector<std::string> cells;
    for (std::vector<std::string> const& row : layout.rows) cells.push_back(row[c]);
    for (std::string const& word : few_words(cells)) add(word);
  }
  if (!rules.asked_for_missing) {
    NumberNotation const notation{rules.decimal, rules.thousands, words};
    for (std::size_t c = 0; c < layout.columns.size(); ++c) {
      if (layout.looks[c] != CellLook::number) continue;
      std::vector<double> values;
      for (std::vector<std::string> const& row : layout.rows) {
        double value = 0;
        values.push_back(parse_cell(row[c], notation, value) == CellKind::number ? value : std::nan(""));
      }
      for (DoubtfulNumber const& each : doubtful_numbers(values)) add(text_of_number(each.value, notation));
    }
  }
  if (words.empty()) return;
  rules.missing = words;
  rules.asked_for_missing = true;
}

void add_words_below(std::string const& bytes, Layout const& layout, ReadingRules& rules) {
  if (layout.last != 0 || !refuse(rules).empty()) return;
  std::size_t constexpr most_words = 6;
  try {
    Table const table = Table::parse_as_told("record", bytes, rules);
    for (std::size_t c = 0; c < layout.columns.size() && c < table.columns().size(); ++c) {
      if (layout.looks[c] != CellLook::number) continue;
      for (std::string const& word : few_words(table.texts(static_cast<int>(c), table.rows())))
        if (std::find(rules.missing.begin(), rules.missing.end(), word) == rules.missing.end() && rules.missing.size() < most_words)
          rules.missing.push_back(word), rules.asked_for_missing = true;
    }
  } catch (UserError const&) {
    return;  // what cannot be read so is not proposed
  }
}

}  // namespace sysid
