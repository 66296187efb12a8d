// Places of panels in pixels.
#include "report/figure/small_multiples.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace sysid::plot {

std::string multiples_excluded(std::size_t count) {
  return count > shown_multiples ? fmt::format(" Shown are the first {} of {}.", shown_multiples, count) : "";
}

SmallMultiples::SmallMultiples(std::size_t count, int per_row, int height_of_each, int below, int above)
    : columns(std::max(1, std::min(per_row, static_cast<int>(count)))),
      rows((static_cast<int>(count) + columns - 1) / columns),
      multiple_width(column_width / columns),
      multiple_height(height_of_each),
      width(column_width),
      height(rows * height_of_each + below + above),
      above_(above) {}

Panel SmallMultiples::panel(std::size_t index, Margins const& margins) const {
  int const column = static_cast<int>(index) % columns, row = static_cast<int>(index) / columns;
  double const x = column * multiple_width, y = height - above_ - (row + 1) * multiple_height;
  return panel_at(x + margins.left, x + multiple_width - margins.right, y + margins.bottom, y + multiple_height - margins.top, {},
                  {});
}

bool SmallMultiples::in_last_row(std::size_t index) const { return static_cast<int>(index) / columns + 1 == rows; }

Panel panel_beside(std::size_t index, std::size_t count, double right, double bottom, double top, Axis x, Axis y) {
  constexpr double gap = 30;
  double const step = (column_width - ordinate_room) / static_cast<double>(count);
  double const left = ordinate_room + static_cast<double>(index) * step;
  return panel_at(left, index + 1 == count ? column_width - right : left + step - gap, bottom, top, std::move(x), std::move(y));
}

}  // namespace sysid::plot
