// Model probabilities and the threshold from population to population: the tutorial's Fig. 8.6.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "report/figure/figures.hpp"
#include "result/selection.hpp"

namespace sysid {

using namespace plot;

Figure population_figure(SelectionReport const& selection) {
  auto const& populations = selection.result.populations;
  auto const& models = selection.result.models;
  std::vector<Key> keys;
  for (std::size_t m = 0; m < models.size(); ++m)
    keys.push_back({m < std::size(chains) ? Key::line : Key::dashes, chains[m % std::size(chains)], models[m].name});
  int const width = column_width, legend_rows = legend_height(keys, 10, width - 14), height = 350 + legend_rows;
  Figure out;
  out.name = "populations";
  out.title = "Models from population to population";
  out.caption =
      "Above, the probability of each model by the weights of its particles. Below, the threshold on a logarithmic scale, "
      "decreasing towards the distance that the noise alone causes.";
  out.script = preamble(out.name, width, height);

  Axis x = axis(1, std::max<double>(2, static_cast<double>(populations.size())), 8, 0.02);
  std::erase_if(x.ticks, [](auto const& tick) { return tick.first != std::floor(tick.first); });
  std::vector<std::vector<double>> rows, thresholds;
  // What has a place on a logarithmic scale: not the first population without a threshold, nor a distance of nothing.
  auto const shown = [](double distance) { return std::isfinite(distance) && distance > 0; };
  bool const floor = selection.floor && shown(*selection.floor);
  double low = floor ? *selection.floor : std::numeric_limits<double>::infinity(), high = floor ? low : 0;
  for (PopulationRecord const& each : populations) {
    if (!shown(each.threshold)) continue;
    low = std::min(low, each.threshold);
    high = std::max(high, each.threshold);
  }
  if (high == 0) low = high = 1;
  // Decades in the scale of the exponent itself: the axis needs no logarithms.
  Axis y = axis(std::log10(low), std::log10(std::max(high, 1.01 * low)), 4, 0.06);
  y.ticks.clear();
  for (int decade = static_cast<int>(std::floor(y.low)); decade <= static_cast<int>(std::ceil(y.high)); ++decade)
    for (int const mantissa : {1, 2, 5}) {
      double const place = decade + std::log10(mantissa);
      if (place < y.low || place > y.high || (mantissa != 1 && y.high - y.low > 2.2)) continue;
      y.ticks.emplace_back(place, fmt::format("{:g}", mantissa * std::pow(10.0, decade)));
    }
  for (std::size_t t = 0; t < populations.size(); ++t) {
    rows.push_back({x.scaled(static_cast<double>(t + 1))});
    for (auto const& model : populations[t].models) rows.back().push_back(model.particles == 0 ? std::nan("") : model.probability);
    if (shown(populations[t].threshold))
      thresholds.push_back({x.scaled(static_cast<double>(t + 1)), std::log10(populations[t].threshold)});
  }
  out.script += data_block("probability", rows);
  if (thresholds.empty()) thresholds.push_back({x.low, y.low});
  out.script += data_block("threshold", thresholds);

  Panel top = panel_at(70, width - 14.0, 164, height - 14.0 - legend_rows, x, axis(0, 1, 4, 0.03));
  top.x_numbers = false;
  top.y_label = "probability";
  out.script += panel(top, width, height);
  out.script += legend(keys, 10, top.right, height - 12.0, width, height);
  out.script += "plot ";
  for (std::size_t m = 0; m < models.size(); ++m)
    out.script += fmt::format("{}$probability using 1:{} with linespoints lw 1.6 pt 7 ps 0.4 {}", m == 0 ? "" : ", ", m + 2,
                              series_colour(m));
  out.script += "\n" + end_legend();

  Panel below = panel_at(top.left, top.right, 44, 146, x, y);
  below.x_label = "population";
  below.y_label = "threshold";
  out.script += panel(below, width, height);
  out.script += "plot ";
  if (floor) out.script += fmt::format("{} with lines lw 1.2 dt 2 lc rgb '{}', ", std::log10(*selection.floor), contrast);
  out.script += fmt::format("$threshold using 1:2 with linespoints lw 1.6 pt 7 ps 0.4 lc rgb '{}'\n", model);
  out.script += "unset multiplot\n";
  if (floor) out.caption += " Dashed: the noise floor.";
  return out;
}

}  // namespace sysid
