// Ranks of true values among posterior draws, small multiples: histograms, and the distribution of ranks minus the uniform one.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/figure/drawing.hpp"
#include "report/figure/figures.hpp"
#include "report/figure/small_multiples.hpp"

namespace sysid {

namespace {

using namespace plot;

Plot histogram_plot(CalibrationReport const& calibration, CalibratedQuantity const& of, std::size_t index, Panel panel) {
  int const bins = calibration.bins, values = calibration.draws + 1;
  std::vector<double> counts(static_cast<std::size_t>(bins), 0);
  for (int const rank : of.ranks) ++counts[static_cast<std::size_t>(rank * bins / values)];
  double const n = static_cast<double>(of.ranks.size()), expected = n / bins;
  double const spread = 1.96 * std::sqrt(expected * (1 - 1.0 / bins));
  std::string const guide = fmt::format("guide{}", index), table = fmt::format("counts{}", index);
  double const low = std::max(0.0, expected - spread), high = expected + spread;
  Rows rows;
  for (int b = 0; b < bins; ++b)
    for (int const edge : {b, b + 1}) rows.push_back({static_cast<double>(edge) / bins, counts[static_cast<std::size_t>(b)]});
  Plot out{std::move(panel),
           {{guide, {{0, low, high}, {1, low, high}}}, {table, std::move(rows)}},
           {band(guide, 2, 3, noise_band), line(table, 2, 1.4, model)}};
  out.panel.x = axis(0, 1, 2);
  out.panel.y = axis(0, 1.08 * std::max(high, *std::max_element(counts.begin(), counts.end())), 3);
  out.panel.y.exponent = 0;
  out.panel.x_label = "rank of " + of.name;
  out.panel.y_label = "records";
  out.panel.y_label_distance = 0;
  return out;
}

Plot ecdf_plot(CalibrationReport const& calibration, CalibratedQuantity const& of, std::size_t index, Panel panel) {
  int const values = calibration.draws + 1;
  std::vector<int> counts(static_cast<std::size_t>(values), 0);
  for (int const rank : of.ranks) ++counts[static_cast<std::size_t>(rank)];
  std::string const bands = fmt::format("bands{}", index), table = fmt::format("ecdf{}", index);
  Rows limits = {{0, 0, 0}}, rows = {{0, 0}};
  double largest = 0;
  int below = 0;
  for (int k = 1; k < values; ++k) {
    below += counts[static_cast<std::size_t>(k - 1)];
    double const at = static_cast<double>(k) / values, difference = below / static_cast<double>(of.ranks.size()) - at;
    double const low = calibration.band_low[static_cast<std::size_t>(k - 1)],
                 high = calibration.band_high[static_cast<std::size_t>(k - 1)];
    limits.push_back({at, low, high});
    rows.push_back({at, difference});
    largest = std::max({largest, std::fabs(difference), -low, high});
  }
  limits.push_back({1, 0, 0});
  rows.push_back({1, 0});
  Plot out{
      std::move(panel),
      {{bands, std::move(limits)}, {table, std::move(rows)}},
      {band(bands, 2, 3, noise_band), level(0, muted), line(table, 2, 1.4, of.shape == RankShape::uniform ? model : contrast)}};
  out.panel.x = axis(0, 1, 2);
  out.panel.y = axis(-largest, largest, 3, 0.05);
  out.panel.y.exponent = 0;
  out.panel.x_label = "rank of " + of.name;
  out.panel.y_label = "";
  return out;
}

using Draw = Plot (*)(CalibrationReport const&, CalibratedQuantity const&, std::size_t, Panel);

std::string multiples(CalibrationReport const& calibration, std::string const& name, std::string const& key, Draw draw) {
  std::size_t const count = std::min(calibration.quantities.size(), shown_multiples);
  SmallMultiples const layout(count, 3, 132, 0, 20);
  Drawing drawing{name, layout.width, layout.height};
  drawing.legend = Legend{{{Key::area, noise_band, key}}, 12, 9};
  for (std::size_t i = 0; i < count; ++i)
    drawing.plots.push_back(draw(calibration, calibration.quantities[i], i, layout.panel(i, {48, 10, 44, 8})));
  return script(drawing);
}

}  // namespace

Figure true_ranks_figure(CalibrationReport const& calibration) {
  Figure out{"true_ranks", "Ranks of the true values", "",
             multiples(calibration, "true_ranks", "95 % band of uniform ranks, for each group by itself", histogram_plot)};
  out.caption = fmt::format(
      "For each record the rank of the true value among {} posterior draws, as a fraction, in {} equal groups. Ranks are uniform "
      "where posteriors are right. Raised ends show posteriors that are too narrow, a hump posteriors that are too wide, a slope "
      "posteriors that lie too low or too high.",
      calibration.draws, calibration.bins);
  out.caption += multiples_excluded(calibration.quantities.size());
  return out;
}

Figure rank_difference_figure(CalibrationReport const& calibration) {
  Figure out{"rank_differences", "Distribution of the ranks minus the uniform one", "",
             multiples(calibration, "rank_differences", "95 % band of uniform ranks, for the whole curve", ecdf_plot)};
  out.caption =
      "The share of records with at most this rank minus the share that is expected. The band contains the whole curve with "
      "probability 0.95 where ranks are uniform (Säilynoja et al. 2022). It is for this quantity alone: one correct curve in "
      "twenty leaves it. The curve has another colour if `p together` (both tests, all quantities) is below 0.01." +
      multiples_excluded(calibration.quantities.size());
  return out;
}

}  // namespace sysid
