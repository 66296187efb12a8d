// What a panel shows: tables of numbers, and series that read them. One constructor for each kind of mark that figures use.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace sysid::plot {

using Rows = std::vector<std::vector<double>>;

/// The numbers of series. An empty row breaks a line.
struct Table {
  std::string name;
  Rows rows;
};

/// Marks of one kind. Columns count from 1.
struct Series {
  std::string source;   // a table as "$NAME", or a number
  std::string columns;  // "1:2"; empty: of a number
  std::string style;    // gnuplot's
};

Series line(std::string_view table, int column, double width, std::string_view colour);
Series dashed_line(std::string_view table, double width, std::string_view colour);
/// A line in the colour of the chain or model of this index.
Series indexed_line(std::string_view table, double width, std::size_t index);
Series points(std::string_view table, int column, double size, std::string_view colour);
/// Open ones, which can be told from dots of another colour in every light.
Series circles(std::string_view table, int column, double size, std::string_view colour);
Series linked_points(std::string_view table, std::string_view colour);
/// Column `2 + index`, in the colour of the chain or model of this index.
Series indexed_linked_points(std::string_view table, std::size_t index);
/// Between two columns.
Series band(std::string_view table, int low, int high, std::string_view colour);
/// A band as one upright bar for each row.
Series upright_bars(std::string_view table, int low, int high, std::string_view colour);
/// Between column 2 and a level.
Series area(std::string_view table, std::string_view colour, double level = 0);
/// Upright lines from 0 to column 2.
Series impulses(std::string_view table, std::string_view colour);
/// A horizontal line through all of the panel.
Series level(double value, std::string_view colour);
Series dashed_level(double value, std::string_view colour);

/// "$fit using 1:2 with lines ..." of each, with commas between; "NaN", which draws axes alone, where there are none.
std::string plot_list(std::vector<Series> const& series);

}  // namespace sysid::plot
