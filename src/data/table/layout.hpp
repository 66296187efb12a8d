// What a text file looks like: how its cells are separated, which of its lines hold names, units and values.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

enum class CellLook { empty, number, stamp, gap, text };

/// number: in any notation; gap: a word that programs write in place of a number.
CellLook look_of(std::string_view unquoted_cell);

struct Layout {
  char separator = ',';
  int names = 0, units = 0;                    // lines; 0: there is none
  int first = 0, last = 0;                     // lines with values; last = 0: the file was too long to be looked at to its end
  bool more_below = false;                     // lines that are no values follow the last one
  int broken = 0;                              // a line within the table that is none of its rows; 0: there is none
  bool ragged = false;                         // rows have other numbers of cells than the names
  char comments = 0;                           // begins lines between the rows
  std::vector<std::string> columns;            // names where there are any; else `column_1`, ...
  std::vector<CellLook> looks;                 // of most rows, per column
  std::vector<std::vector<std::string>> rows;  // cells, without quotes, as many as columns
};

/// Nothing where no lines look like rows of numbers.
std::optional<Layout> find_layout(std::string const& bytes);

}  // namespace sysid
