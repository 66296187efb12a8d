// Horizontal bars one below the other, each between its name and its value.
#pragma once
#include <string>
#include <vector>

#include "report/figure/plot.hpp"

namespace sysid::plot {

struct NamedBar {
  std::string name, value;
  double length = 0;
  bool kept = false;  // in colour
};

struct NamedBars {
  std::string name;
  Axis x;
  std::string x_label;
  std::vector<NamedBar> bars;  // from the top down
};

/// Room is made for the longest name, up to a part of the figure; longer names are shortened.
std::string script(NamedBars const& figure);

}  // namespace sysid::plot
