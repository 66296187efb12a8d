// The pieces of a figure's gnuplot script: axes with chosen ticks and one power of ten, panels, data, and the palette.
#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sysid::plot {

/// A figure before it is drawn: the script alone, data included, is what gnuplot needs.
struct Figure {
  std::string name;  // of its files: figures/NAME.svg, figures/NAME.gnuplot
  std::string title;
  std::string caption;  // what one should see
  std::string script;
};

// One hue for the model, grey for data, a warm one for what is set against them. The page maps these to its own in the dark.
inline constexpr std::string_view ink = "#1f2933", muted = "#66717d", rule = "#e3e7ec", paper = "#ffffff";
inline constexpr std::string_view model = "#1b5e9b", response_band = "#a9c8e4", noise_band = "#dce8f3", data = "#3d4852",
                                  contrast = "#b4541a";
inline constexpr std::string_view chains[] = {"#1b5f9c", "#c8741f", "#2d8a6b", "#7a5195",
                                              "#8c6d31", "#4a90a4", "#a63d57", "#5c7a29"};

/// A range, the power of ten (a multiple of three) its numbers are divided by, and ticks in these numbers.
struct Axis {
  double low = 0, high = 1;  // divided by 10^exponent
  int exponent = 0;
  std::vector<std::pair<double, std::string>> ticks;

  double scaled(double value) const;
  /// Lengthens the range to the next tick when it falls short by a hair (0.499 s to 0.5 s).
  void reach_ticks();
  /// Drops ticks within this share of either end, where they would run into the neighbour's.
  void clear_edges(double share);
};

/// Around [low, high] with a margin of the given share on both sides; about `count` ticks at round numbers.
Axis axis(double low, double high, int count, double margin = 0);

/// "k3 [10⁹ N/m³]"; no brackets when there is nothing to put in them.
std::string axis_label(std::string_view name, std::string_view unit, int exponent = 0);

/// Smallest and largest finite value; {0, 1} when there is none.
std::pair<double, double> range(std::vector<double> const& values);
std::pair<double, double> cover(std::pair<double, double> a, std::pair<double, double> b);

/// A text as gnuplot's quoted string.
std::string quote(std::string_view text);

/// A name for files and identifiers: letters, digits and _ alone.
std::string identifier(std::string_view text);

/// Terminal, fonts, lines: the beginning of each script.
std::string preamble(std::string_view name, int width, int height);

/// `$NAME << EOD`, rows of numbers; an empty row breaks the line.
std::string data_block(std::string_view name, std::vector<std::vector<double>> const& rows);

/// Where a plot stands, in pixels of the figure from its lower left corner, and its axes.
struct Panel {
  double left = 0, right = 0, bottom = 0, top = 0;
  Axis x, y;
  std::string x_label, y_label, title;
  double y_label_distance = 58;
  bool x_numbers = true, y_numbers = true, y_axis = true;
};
Panel panel_at(double left, double right, double bottom, double top, Axis x, Axis y);
std::string panel(Panel const& panel, int width, int height);

/// What a colour stands for, as a row ending at `right`; gnuplot's own key breaks the row at its own discretion. It is drawn with
/// the next plot; `end_legend` keeps it out of those that follow.
struct Key {
  enum Kind { area, line, points } kind;
  std::string_view colour;
  std::string text;
};
std::string legend(std::vector<Key> const& keys, double right, double y, int width, int height);
std::string end_legend();

}  // namespace sysid::plot
