// gnuplot's `splot`.
#include "report/figure/surface.hpp"

#include <fmt/format.h>

namespace sysid::plot {

namespace {

constexpr int surface_height = 310;

std::string axis_ticks(char which, Axis const& axis, char const* offset) {
  std::string list;
  for (auto const& [place, number] : axis.ticks) list += fmt::format("{}'{}' {:.10g}", list.empty() ? "" : ", ", number, place);
  return fmt::format("set {0}tics offset {3} textcolor rgb '{1}' ({2})\n", which, ink, list, offset);
}

/// gnuplot's own labels lie over the numbers of their axes, or are left out in the view below.
std::string surface_label(int number, std::string const& text, char const* place) {
  return fmt::format("set label {} {} at screen {} textcolor rgb '{}'\n", 300 + number, quote(shortened(text, 190)), place, ink);
}

}  // namespace

std::string script(Surface const& surface) {
  Axis const &x = surface.x.axis, &y = surface.y.axis, &z = surface.z.axis;
  std::string out = preamble(surface.name, column_width, surface_height) +
                    legend(surface.legend.keys, Legend::left, column_width - surface.legend.right,
                           surface_height - surface.legend.top, column_width, surface_height);
  out += data_block("mesh", surface.mesh);
  if (!surface.points.empty()) out += data_block("points", surface.points);
  out += fmt::format(
      "set xrange [{:.10g}:{:.10g}]\nset yrange [{:.10g}:{:.10g}]\nset zrange [{:.10g}:{:.10g}]\nset xyplane at {:.10g}\n"
      "set view 50,25,1.08,0.9\nset border 127 lw 0.7\nset grid noxtics noytics noztics\n",
      x.low, x.high, y.low, y.high, z.low, z.high, z.low);
  out += axis_ticks('x', x, "0,-0.2") + axis_ticks('y', y, "0,-0.2") + axis_ticks('z', z, "0.4,0");
  out += surface_label(1, surface.x.label, "0.3,0.07 center") + surface_label(2, surface.y.label, "0.98,0.1 right") +
         surface_label(3, surface.z.label, "0.02,0.68 left");
  std::string const points =
      surface.points.empty() ? "" : fmt::format(", $points using 1:2:3 with points pt 7 ps 0.2 lc rgb '{}'", surface.point_colour);
  return out + fmt::format("splot $mesh using 1:2:3 with lines lw 0.8 lc rgb '{}'{}\nunset multiplot\n", model, points);
}

}  // namespace sysid::plot
