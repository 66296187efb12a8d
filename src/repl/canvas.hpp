// Plots in characters: points and lines in Braille dots, histograms in blocks, axes with their ends.
#pragma once
#include <string>
#include <vector>

namespace sysid::repl {

/// Of the plot alone, in characters.
struct PlotSize {
  int columns = 64, rows = 14;
};

/// What an axis shows; unit may be empty.
struct AxisName {
  std::string name, unit;
};

/// x, y: points of one curve; what is not finite breaks it.
struct Curve {
  std::vector<double> x, y;
  bool joined = true;  // by lines
};

/// Curves in one frame; empty when no point is finite.
std::string plot_curves(std::vector<Curve> const& curves, AxisName const& x, AxisName const& y, PlotSize size = {});

/// How many values fall where; empty when none is finite.
std::string plot_histogram(std::vector<double> const& values, AxisName const& x, PlotSize size = {});

}  // namespace sysid::repl
