// Model probabilities and the threshold from population to population: the tutorial's Fig. 8.6.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "report/figure/drawing.hpp"
#include "report/figure/figures.hpp"
#include "result/selection.hpp"

namespace sysid {

namespace {

using namespace plot;

/// What has a place on a logarithmic scale: not the first population without a threshold, nor a distance of nothing.
bool on_scale(double distance) { return std::isfinite(distance) && distance > 0; }

std::vector<Key> keys_of(SelectionResult const& result) {
  std::vector<Key> keys;
  for (std::size_t m = 0; m < result.models.size(); ++m)
    keys.push_back({m < std::size(chains) ? Key::line : Key::dashes, chains[m % std::size(chains)], result.models[m].name});
  return keys;
}

Axis population_axis(std::size_t populations) {
  Axis x = axis(1, std::max<double>(2, static_cast<double>(populations)), 8, 0.02);
  std::erase_if(x.ticks, [](auto const& tick) { return tick.first != std::floor(tick.first); });
  return x;
}

/// Of thresholds and the floor, in decades: the axis needs no logarithms.
Axis threshold_axis(std::vector<PopulationRecord> const& populations, std::optional<double> floor) {
  double low = floor ? *floor : std::numeric_limits<double>::infinity(), high = floor ? low : 0;
  for (PopulationRecord const& each : populations) {
    if (!on_scale(each.threshold)) continue;
    low = std::min(low, each.threshold);
    high = std::max(high, each.threshold);
  }
  if (high == 0) low = high = 1;
  Axis y = axis(std::log10(low), std::log10(std::max(high, 1.01 * low)), 4, 0.06);
  y.ticks.clear();
  for (int decade = static_cast<int>(std::floor(y.low)); decade <= static_cast<int>(std::ceil(y.high)); ++decade)
    for (int const mantissa : {1, 2, 5}) {
      double const place = decade + std::log10(mantissa);
      if (place < y.low || place > y.high || (mantissa != 1 && y.high - y.low > 2.2)) continue;
      y.ticks.emplace_back(place, fmt::format("{:g}", mantissa * std::pow(10.0, decade)));
    }
  return y;
}

Table probability_table(std::vector<PopulationRecord> const& populations, Axis const& x) {
  Table out{"probability", {}};
  for (std::size_t t = 0; t < populations.size(); ++t) {
    std::vector<double>& row = out.rows.emplace_back(1, x.scaled(static_cast<double>(t + 1)));
    for (auto const& model : populations[t].models) row.push_back(model.particles == 0 ? std::nan("") : model.probability);
  }
  return out;
}

Table threshold_table(std::vector<PopulationRecord> const& populations, Axis const& x, Axis const& y) {
  Table out{"threshold", {}};
  for (std::size_t t = 0; t < populations.size(); ++t)
    if (on_scale(populations[t].threshold))
      out.rows.push_back({x.scaled(static_cast<double>(t + 1)), std::log10(populations[t].threshold)});
  if (out.rows.empty()) out.rows.push_back({x.low, y.low});
  return out;
}

}  // namespace

Figure population_figure(SelectionReport const& selection) {
  auto const& populations = selection.result.populations;
  std::optional<double> const floor = selection.floor && on_scale(*selection.floor) ? selection.floor : std::nullopt;
  Legend legend{keys_of(selection.result)};
  legend.after_first_panel = true;
  int const left = 70, right = column_width - 14, legend_rows = legend.height();
  Drawing drawing{"populations", column_width, 350 + legend_rows, std::move(legend)};
  Axis const x = population_axis(populations.size()), y = threshold_axis(populations, floor);

  Plot top{panel_at(left, right, 164, drawing.height - 14.0 - legend_rows, x, axis(0, 1, 4, 0.03)),
           {probability_table(populations, x), threshold_table(populations, x, y)}};
  top.panel.x_numbers = false;
  top.panel.y_label = "probability";
  for (std::size_t m = 0; m < selection.result.models.size(); ++m) top.series.push_back(indexed_linked_points("probability", m));
  drawing.plots.push_back(std::move(top));

  Plot below{panel_at(left, right, 44, 146, x, y)};
  below.panel.x_label = "population";
  below.panel.y_label = "threshold";
  if (floor) below.series.push_back(dashed_level(std::log10(*floor), contrast));
  below.series.push_back(linked_points("threshold", model));
  drawing.plots.push_back(std::move(below));

  Figure out{"populations", "Models from population to population", "", script(drawing)};
  out.caption =
      "Above, the probability of each model by the weights of its particles. Below, the threshold on a logarithmic scale, "
      "decreasing towards the distance that the noise alone causes.";
  if (floor) out.caption += " Dashed: the noise floor.";
  return out;
}

}  // namespace sysid
