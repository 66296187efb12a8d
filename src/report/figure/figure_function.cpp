// Unknown functions as curves with bands.
#include <fmt/format.h>

#include <algorithm>

#include "report/figure/figures.hpp"

namespace sysid {

using namespace plot;

namespace {

/// How often the record reads the function along an input, as the outline of bars from the lower edge of the panel; empty where
/// that is not known.
std::vector<std::vector<double>> visit_strip(FunctionReport const& function, std::size_t input, Axis const& x, Axis const& y) {
  constexpr double tallest = 0.12;  // of the panel
  std::vector<std::vector<double>> out;
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

}  // namespace

Figure function_figure(FunctionReport const& function) {
  constexpr int most_columns = 3, tall = 230;
  int const count = static_cast<int>(function.cuts.size()), columns = std::min(count, most_columns);
  int const width = column_width, height = tall * ((count + most_columns - 1) / most_columns);
  Figure out;
  out.name = "function_" + identifier(function.name);
  out.title = fmt::format("The estimated function {}", function.name);
  out.caption = fmt::format(
      "The function and its 90 % band, given the draws of the other parameters (for an optimum, given their single value){}.",
      count == 1 ? "" : ", along each input, with the others at a central value");
  out.script = preamble(out.name, width, height);
  std::pair<double, double> values{0, 0};
  for (auto const& cut : function.cuts)
    for (FunctionPoint const& point : cut) values = cover(values, finite_range({point.q5, point.q95, point.mean}));
  Axis const y = axis(values.first, values.second, 4, 0.06);
  for (int d = 0; d < count; ++d) {
    auto const i = static_cast<std::size_t>(d);
    auto const& cut = function.cuts[i];
    Axis const x = axis(cut.front().inputs[i], cut.back().inputs[i], count == 1 ? 6 : 3);
    int const column = d % columns;
    double const step = (width - 70.0) / columns, left = 70 + column * step, top = height - 12.0 - tall * (d / columns);
    Panel p = panel_at(left, column + 1 == columns ? width - 16.0 : left + step - 30, top - tall + 56, top, x, y);
    p.x_label = axis_label(function.inputs[i].first, function.inputs[i].second, x);
    if (column == 0) p.y_label = axis_label(function.name, function.unit, y);
    p.y_numbers = column == 0;
    std::vector<std::vector<double>> rows;
    for (FunctionPoint const& point : cut)
      rows.push_back({x.scaled(point.inputs[i]), y.scaled(point.mean), y.scaled(point.q5), y.scaled(point.q95)});
    out.script += data_block(fmt::format("cut{}", d), rows);
    auto const strip = visit_strip(function, i, x, y);
    if (!strip.empty()) out.script += data_block(fmt::format("visits{}", d), strip);
    out.script += panel(p, width, height);
    out.script += fmt::format(
        "plot $cut{0} using 1:3:4 with filledcurves fc rgb '{1}' fs noborder, $cut{0} using 1:2 with lines lw 1.6 lc rgb "
        "'{2}'{3}\n",
        d, response_band, model,
        strip.empty() ? ""
                      : fmt::format(", $visits{} using 1:2 with filledcurves y1={:.10g} fc rgb '{}' fs noborder", d, y.low, muted));
  }
  out.script += "unset multiplot\n";
  if (out.script.find("$visits") != std::string::npos)
    out.caption +=
        " Bars along the bottom: how many of the fitted rows use the function there; without bars the curve follows from its "
        "prior.";
  return out;
}

}  // namespace sysid
