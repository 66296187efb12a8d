// A surface over two quantities, seen from above at an angle, with points on it.
#pragma once
#include <string>

#include "report/figure/drawing.hpp"

namespace sysid::plot {

struct SurfaceAxis {
  Axis axis;
  std::string label;
};

struct Surface {
  std::string name;
  Legend legend;
  SurfaceAxis x, y, z;
  /// Rows of {x, y, z}: of the mesh line after line, with an empty row between lines.
  Rows mesh, points;
  std::string_view point_colour;
};

std::string script(Surface const& surface);

}  // namespace sysid::plot
