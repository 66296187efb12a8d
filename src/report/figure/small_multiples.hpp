// Small plots in rows, one for each parameter.
#pragma once
#include <cstddef>
#include <string>

#include "report/figure/plot.hpp"

namespace sysid::plot {

/// A figure holds no more cells.
inline constexpr std::size_t shown_cells = 18;

/// " Shown are the first 18 of 40."; empty when all are shown.
std::string cells_left_out(std::size_t count);

/// Cells in rows of `per_row` in one column of print, each with room for its labels; pixels.
struct Cells {
  int columns, rows, cell_width, cell_height, width, height;

  /// below, above: pixels under the last row and over the first.
  Cells(std::size_t cells, int per_row, int cell_height, int below = 0, int above = 0);
  /// The panel of a cell, within these distances from its edges.
  Panel cell(std::size_t index, double left, double right, double bottom, double top) const;

 private:
  int above_;
};

}  // namespace sysid::plot
