// Unknown functions as curves with bands.
#include <fmt/format.h>

#include <algorithm>

#include "report/figure/drawing.hpp"
#include "report/figure/figures.hpp"
#include "report/figure/small_multiples.hpp"

namespace sysid {

using namespace plot;

namespace {

/// How often the record reads the function along an input, as the outline of bars from the lower edge of the panel; empty where
/// that is not known.
Rows visit_strip(FunctionReport const& function, std::size_t input, Axis const& x, Axis const& y) {
  constexpr double tallest = 0.12;  // of the panel
  Rows out;
  if (input >= function.visits.size() || function.cuts[input].empty()) return out;
  std::vector<double> const& visits = function.visits[input];
  double const most = visits.empty() ? 0 : *std::max_element(visits.begin(), visits.end());
  if (!(most > 0)) return out;
  double const low = function.cuts[input].front().inputs[input], high = function.cuts[input].back().inputs[input];
  for (std::size_t k = 0; k < visits.size(); ++k)
    for (std::size_t const edge : {k, k + 1})
      out.push_back({x.scaled(low + (high - low) * static_cast<double>(edge) / static_cast<double>(visits.size())),
                     y.low + tallest * (y.high - y.low) * visits[k] / most});
  return out;
}

Axis value_axis(FunctionReport const& function) {
  std::pair<double, double> values{0, 0};
  for (auto const& cut : function.cuts)
    for (FunctionPoint const& point : cut) values = cover(values, finite_range({point.q5, point.q95, point.mean}));
  return axis(values.first, values.second, 4, 0.06);
}

/// Mean and band along an input, and below them where the record reads the function.
void add_cut(Plot& plot, FunctionReport const& function, std::size_t input) {
  Axis const &x = plot.panel.x, &y = plot.panel.y;
  Table cut{fmt::format("cut{}", input), {}}, visits{fmt::format("visits{}", input), visit_strip(function, input, x, y)};
  for (FunctionPoint const& point : function.cuts[input])
    cut.rows.push_back({x.scaled(point.inputs[input]), y.scaled(point.mean), y.scaled(point.q5), y.scaled(point.q95)});
  plot.series = {band(cut.name, 3, 4, response_band), line(cut.name, 2, 1.6, model)};
  plot.tables.push_back(std::move(cut));
  if (visits.rows.empty()) return;
  plot.series.push_back(area(visits.name, muted, y.low));
  plot.tables.push_back(std::move(visits));
}

}  // namespace

Figure function_figure(FunctionReport const& function) {
  constexpr std::size_t most_columns = 3;
  constexpr int tall = 230;
  std::size_t const count = function.cuts.size(), columns = std::min(count, most_columns);
  Drawing drawing{"function_" + identifier(function.name), column_width,
                  tall * static_cast<int>((count + most_columns - 1) / most_columns)};
  Axis const y = value_axis(function);
  bool visited = false;
  for (std::size_t i = 0; i < count; ++i) {
    auto const& cut = function.cuts[i];
    std::size_t const column = i % columns;
    double const top = drawing.height - 12.0 - tall * static_cast<int>(i / columns);
    Plot plot{panel_beside(column, columns, 16, top - tall + 56, top,
                           axis(cut.front().inputs[i], cut.back().inputs[i], count == 1 ? 6 : 3), y)};
    plot.panel.x_label = axis_label(function.inputs[i].first, function.inputs[i].second, plot.panel.x);
    plot.panel.y_numbers = column == 0;
    if (column == 0) plot.panel.y_label = axis_label(function.name, function.unit, y);
    add_cut(plot, function, i);
    visited = visited || plot.tables.size() > 1;
    drawing.plots.push_back(std::move(plot));
  }
  Figure out{drawing.name, fmt::format("The estimated function {}", function.name), "", script(drawing)};
  out.caption = fmt::format(
      "The function and its 90 % band, given the draws of the other parameters (for an optimum, given their single value){}.",
      count == 1 ? "" : ", along each input, with the other inputs at a central value");
  if (visited)
    out.caption +=
        " Bars along the bottom: how many of the fitted rows use the function there; where there are no bars, the curve follows "
        "from "
        "its prior.";
  return out;
}

}  // namespace sysid
