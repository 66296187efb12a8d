// Where panels stand: small multiples, one for each parameter, and panels that share an ordinate.
#pragma once
#include <cstddef>
#include <string>

#include "report/figure/plot.hpp"

namespace sysid::plot {

/// A figure holds no more small multiples.
inline constexpr std::size_t shown_multiples = 18;

/// " Shown are the first 18 of 40."; empty when all are shown.
std::string multiples_excluded(std::size_t count);

/// Pixels from the edges of a small multiple to its panel: room for numbers and labels.
struct Margins {
  double left, right, bottom, top;
};

/// Small multiples in rows of `per_row` in one column of print, each with room for its labels; pixels.
struct SmallMultiples {
  int columns, rows, multiple_width, multiple_height, width, height;

  /// below, above: pixels under the last row and over the first.
  SmallMultiples(std::size_t count, int per_row, int multiple_height, int below = 0, int above = 0);
  Panel panel(std::size_t index, Margins const& margins) const;
  bool in_last_row(std::size_t index) const;

 private:
  int above_;
};

/// Pixels at the left for the numbers and the label of an ordinate that panels side by side share.
inline constexpr double ordinate_room = 70;

/// The panel of this index among `count` side by side in one column of print, the last of which ends `right` pixels from the edge.
Panel panel_beside(std::size_t index, std::size_t count, double right, double bottom, double top, Axis x, Axis y);

}  // namespace sysid::plot
