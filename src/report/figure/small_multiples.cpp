// Where cells stand.
#include "report/figure/small_multiples.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace sysid::plot {

std::string cells_left_out(std::size_t count) {
  return count > shown_cells ? fmt::format(" Shown are the first {} of {}.", shown_cells, count) : "";
}

Cells::Cells(std::size_t cells, int per_row, int cell_height_, int below, int above)
    : columns(std::max(1, std::min(per_row, static_cast<int>(cells)))),
      rows((static_cast<int>(cells) + columns - 1) / columns),
      cell_width(column_width / columns),
      cell_height(cell_height_),
      width(column_width),
      height(rows * cell_height_ + below + above),
      above_(above) {}

Panel Cells::cell(std::size_t index, double left, double right, double bottom, double top) const {
  int const column = static_cast<int>(index) % columns, row = static_cast<int>(index) / columns;
  double const x = column * cell_width, y = height - above_ - (row + 1) * cell_height;
  return panel_at(x + left, x + cell_width - right, y + bottom, y + cell_height - top, {}, {});
}

}  // namespace sysid::plot
