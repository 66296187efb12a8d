// Kinds of marks in gnuplot's words.
#include "report/figure/series.hpp"

#include <fmt/format.h>

#include "report/figure/plot.hpp"

namespace sysid::plot {

namespace {

Series of(std::string_view table, std::string columns, std::string style) {
  return {fmt::format("${}", table), std::move(columns), std::move(style)};
}

std::string column_after_first(int column) { return fmt::format("1:{}", column); }

}  // namespace

Series line(std::string_view table, int column, double width, std::string_view colour) {
  return of(table, column_after_first(column), fmt::format("lines lw {} lc rgb '{}'", width, colour));
}

Series dashed_line(std::string_view table, double width, std::string_view colour) {
  return of(table, column_after_first(2), fmt::format("lines lw {} dt (6,4) lc rgb '{}'", width, colour));
}

Series indexed_line(std::string_view table, double width, std::size_t index) {
  return of(table, column_after_first(2), fmt::format("lines lw {} {}", width, series_colour(index)));
}

Series points(std::string_view table, int column, double size, std::string_view colour) {
  return of(table, column_after_first(column), fmt::format("points pt 7 ps {} lc rgb '{}'", size, colour));
}

Series circles(std::string_view table, int column, double size, std::string_view colour) {
  return of(table, column_after_first(column), fmt::format("points pt 6 ps {} lc rgb '{}'", size, colour));
}

Series linked_points(std::string_view table, std::string_view colour) {
  return of(table, column_after_first(2), fmt::format("linespoints lw 1.6 pt 7 ps 0.4 lc rgb '{}'", colour));
}

Series indexed_linked_points(std::string_view table, std::size_t index) {
  return of(table, column_after_first(static_cast<int>(index) + 2),
            fmt::format("linespoints lw 1.6 pt 7 ps 0.4 {}", series_colour(index)));
}

Series band(std::string_view table, int low, int high, std::string_view colour) {
  return of(table, fmt::format("1:{}:{}", low, high), fmt::format("filledcurves fc rgb '{}' fs noborder", colour));
}

Series upright_bars(std::string_view table, int low, int high, std::string_view colour) {
  return of(table, fmt::format("1:{0}:(0):(${1}-${0})", low, high), fmt::format("vectors nohead lw 2.4 lc rgb '{}'", colour));
}

Series area(std::string_view table, std::string_view colour, double level) {
  return of(table, column_after_first(2), fmt::format("filledcurves y1={:.10g} fc rgb '{}' fs noborder", level, colour));
}

Series impulses(std::string_view table, std::string_view colour) {
  return of(table, column_after_first(2), fmt::format("impulses lw 2.4 lc rgb '{}'", colour));
}

Series level(double value, std::string_view colour) {
  return {fmt::format("{}", value), "", fmt::format("lines lw 1 lc rgb '{}'", colour)};
}

Series dashed_level(double value, std::string_view colour) {
  return {fmt::format("{}", value), "", fmt::format("lines lw 1.2 dt 2 lc rgb '{}'", colour)};
}

std::string plot_list(std::vector<Series> const& series) {
  if (series.empty()) return "NaN";
  std::string out;
  for (Series const& each : series)
    out += fmt::format("{}{}{}{} with {}", out.empty() ? "" : ", ", each.source, each.columns.empty() ? "" : " using ",
                       each.columns, each.style);
  return out;
}

}  // namespace sysid::plot
