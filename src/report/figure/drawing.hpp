// A figure as data: its size, its legend, and its panels with what each of them shows. `script` writes it for gnuplot.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "report/figure/plot.hpp"
#include "report/figure/series.hpp"

namespace sysid::plot {

/// A text in the middle of a panel, in place of axes and series.
struct Note {
  std::string text;
  std::string_view colour;
};

/// One panel. Series are drawn in their order, the last on top.
struct Plot {
  Panel panel;
  std::vector<Table> tables = {};
  std::vector<Series> series = {};  // none: axes alone
  std::optional<Note> note = {};
};

/// Keys in rows at the top of a figure.
struct Legend {
  static constexpr double left = 10;  // pixels from the left edge
  std::vector<Key> keys;
  double right = 14, top = 12;     // pixels from the right edge, and from the top edge to the middle of the first row
  bool after_first_panel = false;  // in the script; the picture is the same

  /// Pixels that it takes in one column of print.
  int height() const;
};

struct Drawing {
  std::string name;
  int width = column_width, height = 0;
  std::optional<Legend> legend = {};
  bool grid = true;
  std::vector<Plot> plots = {};
};

std::string script(Drawing const& drawing);

}  // namespace sysid::plot
