// Unknown functions as a table and as curves with bands.
#include "report/function.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "report/csv.hpp"
#include "report/plot.hpp"

namespace sysid {

using namespace plot;

std::string function_csv(FunctionReport const& function) {
  std::string out = fmt::format("# {} [{}] of", function.name, function.unit.empty() ? "-" : function.unit);
  for (auto const& [name, unit] : function.inputs) out += fmt::format(" {} [{}]", name, unit.empty() ? "-" : unit);
  out += '\n';
  for (auto const& input : function.inputs) out += csv_field(input.first) + ',';
  out += "mean,sd,q5,q95\n";
  for (FunctionPoint const& point : function.grid) {
    for (double const input : point.inputs) out += fmt::format("{},", input);
    out += fmt::format("{},{},{},{}\n", point.mean, point.sd, point.q5, point.q95);
  }
  return out;
}

Figure function_figure(FunctionReport const& function) {
  int const width = column_width, height = 230, count = static_cast<int>(function.cuts.size());
  Figure out;
  out.name = "function_" + identifier(function.name);
  out.title = fmt::format("The function {} that was found", function.name);
  out.caption =
      fmt::format("The function and the band that holds it with 90 %: of the draws, at an optimum by its Laplace approximation{}.",
                  count == 1 ? "" : ", along each input with the others in the middle of their range");
  out.script = preamble(out.name, width, height);
  std::pair<double, double> values{0, 0};
  for (auto const& cut : function.cuts)
    for (FunctionPoint const& point : cut) values = cover(values, range({point.q5, point.q95, point.mean}));
  Axis const y = axis(values.first, values.second, 4, 0.06);
  for (int d = 0; d < count; ++d) {
    auto const i = static_cast<std::size_t>(d);
    auto const& cut = function.cuts[i];
    Axis const x = axis(cut.front().inputs[i], cut.back().inputs[i], count == 1 ? 6 : 3);
    double const step = (width - 70.0) / count, left = 70 + d * step;
    Panel p = panel_at(left, d + 1 == count ? width - 16.0 : left + step - 30, 44, height - 12.0, x, y);
    p.x_label = axis_label(function.inputs[i].first, function.inputs[i].second, x);
    if (d == 0) p.y_label = axis_label(function.name, function.unit, y);
    p.y_numbers = d == 0;
    std::vector<std::vector<double>> rows;
    for (FunctionPoint const& point : cut)
      rows.push_back({x.scaled(point.inputs[i]), y.scaled(point.mean), y.scaled(point.q5), y.scaled(point.q95)});
    out.script += data_block(fmt::format("cut{}", d), rows);
    out.script += panel(p, width, height);
    out.script += fmt::format(
        "plot $cut{0} using 1:3:4 with filledcurves fc rgb '{1}' fs noborder, $cut{0} using 1:2 with lines lw 1.6 lc rgb '{2}'\n",
        d, response_band, model);
  }
  out.script += "unset multiplot\n";
  return out;
}

}  // namespace sysid
