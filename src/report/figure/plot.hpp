// The pieces of a figure's gnuplot script: axes with chosen ticks and one power of ten, panels, data, and the palette.
#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/numeric/statistics.hpp"

namespace sysid::plot {

/// The part of a page that a figure stands in: what was found, how it fits the record, whether the chains agree.
enum class Topic { result, fit, states, chains };

/// A figure before it is drawn: the script alone, data included, is what gnuplot needs.
struct Figure {
  std::string name;  // of its files: figures/NAME.svg, figures/NAME.gnuplot
  std::string title;
  std::string caption;  // what one should see
  std::string script;
  Topic topic = Topic::result;
};

/// Pixels of a figure that stands in one column of print, 85 mm: its 12 pixels high text is 6 points there. A page of two columns
/// takes twice as many.
inline constexpr int column_width = 480;

// One hue for the model, grey for data, a warm one for what is set against them; chains and models of a selection differ also for
// readers who do not see red or green. The page maps these to its own in the dark.
inline constexpr std::string_view ink = "#1f2933", muted = "#66717d", rule = "#e3e7ec", paper = "#ffffff";
inline constexpr std::string_view model = "#1b5e9b", response_band = "#a9c8e4", noise_band = "#dce8f3", data = "#3d4852",
                                  contrast = "#b4541a";
inline constexpr std::string_view chains[] = {"#1b5f9c", "#c8741f", "#44aa99", "#882255",
                                              "#56b4e9", "#6b4226", "#332288", "#101418"};

/// The colour of the series of this index, and behind the last colour the same ones dashed: "lc rgb '#1b5f9c' dt 1".
std::string series_colour(std::size_t index);

/// A range, the power of ten (a multiple of three) its numbers are divided by, and ticks in these numbers. Of what varies by less
/// than its hundred thousandth part the numbers are counted from `origin`.
struct Axis {
  double low = 0, high = 1;  // divided by 10^exponent
  int exponent = 0;
  std::vector<std::pair<double, std::string>> ticks;
  double origin = 0;
  std::string origin_text = {};  // "15.9145"; empty: 0

  double scaled(double value) const;
  double unscaled(double number) const;
  /// Of a difference.
  double scaled_width(double width) const;
  /// Numbers that would run into each other are left out, the ticks stay, two numbers where there is room for two: `pixels` is the
  /// length of the axis.
  void thin_numbers(double pixels, bool upright);
  /// Lengthens the range to the next tick when it falls short by a hair (0.499 s to 0.5 s).
  void reach_ticks();
  /// Drops ticks within this share of either end, where they would run into the neighbour's.
  void clear_edges(double share);
  /// How many of its ticks have numbers.
  std::size_t numbers() const;
};

/// Around [low, high] with a margin of the given share on both sides; about `count` ticks at round numbers.
Axis axis(double low, double high, int count, double margin = 0);

/// "k3 [10⁹ N/m³]"; no brackets when there is nothing to put in them.
std::string axis_label(std::string_view name, std::string_view unit, int exponent = 0);
/// The same with what the numbers are counted from: "f0 − 15.9145 [µHz]".
std::string axis_label(std::string_view name, std::string_view unit, Axis const& axis);

/// About how many pixels a text is wide.
double text_pixels(std::string_view text);
/// A text that is wider loses the middle of its name; where that does not do, its unit, but for the power of ten: "k3 [10³ …]".
std::string shortened(std::string_view text, double pixels);

std::pair<double, double> cover(std::pair<double, double> a, std::pair<double, double> b);

/// A text as gnuplot's quoted string.
std::string quote(std::string_view text);

/// A name for files and identifiers: letters, digits and _ alone.
std::string identifier(std::string_view text);

/// Terminal, fonts, lines: the beginning of each script. gnuplot's variable `format` says which picture becomes of it: 'svg',
/// 'png', 'pdf', or 'text' in `columns` columns of characters, on `lines` lines; 0: as many as keep the shape.
std::string preamble(std::string_view name, int width, int height, int lines = 0);
/// Gives a figure another name, in its script, which begins with a preamble, too.
void rename(Figure& figure, std::string const& name);

/// `$NAME << EOD`, rows of numbers; an empty row breaks the line.
std::string data_block(std::string_view name, std::vector<std::vector<double>> const& rows);

/// Where a plot stands, in pixels of the figure from its lower left corner, and its axes.
struct Panel {
  double left = 0, right = 0, bottom = 0, top = 0;
  Axis x, y;
  std::string x_label, y_label, title;
  double y_label_distance = 58;
  double x_label_room = 0, y_label_room = 0;  // pixels, longer labels are shortened; 0: a little more than the axis
  bool x_numbers = true, y_numbers = true, y_axis = true;
};
Panel panel_at(double left, double right, double bottom, double top, Axis x, Axis y);
std::string panel(Panel const& panel, int width, int height);

/// What a colour stands for, in as many rows as are needed between `left` and `right`; gnuplot's own key breaks rows at its own
/// discretion. It is drawn with the next plot; `end_legend` keeps it out of those that follow.
struct Key {
  enum Kind { area, line, points, circles, dashes } kind;
  std::string_view colour;
  std::string text;
};
/// y: of the uppermost row.
std::string legend(std::vector<Key> const& keys, double left, double right, double y, int width, int height);
/// Pixels that the rows take.
int legend_height(std::vector<Key> const& keys, double left, double right);
std::string end_legend();

}  // namespace sysid::plot
