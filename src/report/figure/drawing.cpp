// The script of a drawing: preamble, legend, and panel after panel.
#include "report/figure/drawing.hpp"

#include <fmt/format.h>

namespace sysid::plot {

namespace {

std::string legend_text(Drawing const& drawing) {
  Legend const& of = *drawing.legend;
  return legend(of.keys, Legend::left, drawing.width - of.right, drawing.height - of.top, drawing.width, drawing.height);
}

std::string note_text(Note const& note, Panel const& at, Drawing const& drawing) {
  return fmt::format("set label 1 '{}' at screen {:.5f},{:.5f} center textcolor rgb '{}'\n", note.text,
                     (at.left + at.right) / 2 / drawing.width, (at.bottom + at.top) / 2 / drawing.height, note.colour) +
         panel(at, drawing.width, drawing.height) +
         "unset border\nunset xtics\nunset ytics\nset xlabel ''\nplot NaN notitle\nunset label 1\n";
}

}  // namespace

int Legend::height() const { return legend_height(keys, left, column_width - right); }

std::string script(Drawing const& drawing) {
  std::string out = preamble(drawing.name, drawing.width, drawing.height);
  if (drawing.legend && !drawing.legend->after_first_panel) out += legend_text(drawing);
  if (!drawing.grid) out += "set grid noxtics noytics\n";
  for (Plot const& plot : drawing.plots) {
    bool const first = &plot == &drawing.plots.front();
    for (Table const& table : plot.tables) out += data_block(table.name, table.rows);
    if (plot.note) {
      out += note_text(*plot.note, plot.panel, drawing);
    } else {
      out += panel(plot.panel, drawing.width, drawing.height);
      if (drawing.legend && drawing.legend->after_first_panel && first) out += legend_text(drawing);
      out += "plot " + plot_list(plot.series) + '\n';
    }
    // A legend is drawn with the first plot.
    if (drawing.legend && first) out += end_legend();
  }
  return out + "unset multiplot\n";
}

}  // namespace sysid::plot
