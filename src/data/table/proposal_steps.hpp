// The steps from the look of a file to rules that may read it: each adds the settings of one kind.
#pragma once
#include <string>
#include <vector>

#include "data/table/layout.hpp"
#include "data/table/proposal.hpp"
#include "data/table/reading_rules.hpp"

namespace sysid {

/// Rules of which one may be right, and what to ask.
struct Alternatives {
  std::vector<ReadingRules> rules;
  std::string question;
};

template <class OnNumber>
void each_cell_of_numbers(Layout const& layout, OnNumber on_number) {
  for (std::vector<std::string> const& row : layout.rows)
    for (std::size_t c = 0; c < row.size() && c < layout.looks.size(); ++c)
      if (layout.looks[c] == CellLook::number) on_number(row[c]);
}

/// Which lines are what, and how cells are separated.
void add_lines(std::string const& bytes, Layout const& layout, ReadingRules& rules);
/// Decimal sign and groups, from all numbers of the file.
void add_notation(Layout const& layout, Alternatives& all);
/// Words and marks in place of numbers, as they are written.
void add_missing(Layout const& layout, ReadingRules& rules);
/// Words of lines beyond those that were looked at.
void add_words_below(std::string const& bytes, Layout const& layout, ReadingRules& rules);
/// The pattern of dates and times in the column `wanted`; of a date there, the column with the time of day beside it.
void add_stamps(Layout const& layout, std::string const& wanted, Proposal& proposal, Alternatives& all);

}  // namespace sysid
