// Bars as boxes; in characters as lines, with margins counted in characters.
#include "report/figure/named_bars.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/text/number.hpp"
#include "core/text/utf8.hpp"
#include "report/figure/series.hpp"

namespace sysid::plot {

namespace {

constexpr int bar_height = 18;
/// Of characters each bar has one line, above those of the axis, its numbers and its label.
constexpr int lines_below = 3;
/// Characters.
constexpr int value_width = 13;

double room_for_names(std::vector<NamedBar> const& bars) {
  double widest = 40;
  for (NamedBar const& bar : bars) widest = std::max(widest, text_pixels(bar.name));
  return std::min(widest + 30, 230.0);
}

/// Names and values as labels, in the middle of each bar's row.
std::string bar_labels(std::size_t index, NamedBar const& bar, std::string const& name, double length, double y) {
  return fmt::format("set label {} {} at graph 0, first {:.6g} right offset -1,0 textcolor rgb '{}'\n", 100 + 2 * index,
                     quote(name), y, bar.kept ? ink : muted) +
         // Characters have no colour to tell what was kept.
         fmt::format("set label {} (format eq 'text' ? ' {}{}' : '{}') at first {:.6g},{:.6g} left offset 1,0 textcolor rgb '{}'\n",
                     101 + 2 * index, bar.value, bar.kept ? " kept" : "", bar.value, length, y, muted);
}

/// Tables of the bars in colour and of the others, and how each is plotted: as boxes, and in characters.
struct PlotText {
  std::string tables, boxes, lines;

  void add(char const* name, Rows const& rows, std::string_view colour) {
    if (rows.empty()) return;
    tables += data_block(name, rows);
    boxes += fmt::format("{}${} using 1:2:3:4:5:6 with boxxyerror fc rgb '{}' fs solid noborder", boxes.empty() ? "plot " : ", ",
                         name, colour);
    lines += fmt::format("{}${} using 3:2:4:(0) with vectors nohead", lines.empty() ? "plot " : ", ", name);
  }
};

}  // namespace

std::string script(NamedBars const& figure) {
  std::size_t const count = figure.bars.size();
  int const height = 62 + bar_height * static_cast<int>(count);
  double const left = room_for_names(figure.bars);
  Panel p = panel_at(left, column_width - 62.0, 44, height - 12.0, figure.x, {0, static_cast<double>(count), 0, {}});
  p.x_label = figure.x_label;
  p.y_axis = false;
  Rows kept, others;
  std::string labels;
  int longest = 0;
  for (std::size_t r = 0; r < count; ++r) {
    NamedBar const& bar = figure.bars[r];
    double const y = static_cast<double>(count - r) - 0.5, end = p.x.scaled(bar.length);
    (bar.kept ? kept : others).push_back({end / 2, y, 0, end, y - 0.34, y + 0.34});
    std::string const name = shortened(bar.name, left - 26);
    longest = std::max(longest, text_width(name));
    labels += bar_labels(r, bar, name, end, y);
  }
  PlotText plot;
  plot.add("kept", kept, model);
  plot.add("dropped", others, muted);
  if (plot.boxes.empty()) plot.boxes = plot.lines = "plot NaN";
  // Margins of characters, so that names and values have room however few columns there are.
  return preamble(figure.name, column_width, height, static_cast<int>(count) + lines_below + 1) + plot.tables +
         panel(p, column_width, height) + labels +
         fmt::format(
             "if (format eq 'text') {{\nset lmargin {}\nset rmargin {}\nset bmargin {}\nset tmargin 0\n{}\n}} else {{\n{}\n}}\n"
             "unset multiplot\n",
             longest + 2, value_width, lines_below, plot.lines, plot.boxes);
}

}  // namespace sysid::plot
