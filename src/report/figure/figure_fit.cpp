// Figures along the record: fit or prediction with bands and residuals.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/figure/figures.hpp"

namespace sysid {

namespace {

using namespace plot;

/// More samples than this in a column are a blot.
constexpr std::size_t shown_samples = 600;

struct Window {
  std::size_t first = 0, count = 0;
  bool whole = true;
};

/// The first scored samples, from the first scored one on.
Window window(Prediction const& prediction) {
  std::size_t first = 0, last = prediction.time.size();
  while (first < last && prediction.scored[first] == 0) ++first;
  while (last > first && prediction.scored[last - 1] == 0) --last;
  if (first == last) {
    first = 0;
    last = prediction.time.size();
  }
  bool const whole = last - first <= shown_samples;
  return {first, whole ? last - first : shown_samples, whole};
}

std::vector<double> cut(std::vector<double> const& values, Window w) {
  if (values.empty()) return {};
  auto const begin = values.begin() + static_cast<std::ptrdiff_t>(w.first);
  return {begin, begin + static_cast<std::ptrdiff_t>(w.count)};
}

std::string figure_name(std::string_view what, Prediction const& prediction, PredictedQuantity const& quantity) {
  return identifier(fmt::format("{}_{}_{}", what, prediction.experiment, quantity.name));
}

}  // namespace

Figure fit_figure(Prediction const& prediction, PredictedQuantity const& quantity) {
  Window const w = window(prediction);
  std::vector<double> time = cut(prediction.time, w);
  std::vector<double> const mean = cut(quantity.response.mean, w), lower = cut(quantity.response.lower, w),
                            upper = cut(quantity.response.upper, w), noisy_lower = cut(quantity.noisy.lower, w),
                            noisy_upper = cut(quantity.noisy.upper, w), measured = cut(quantity.measured, w);
  if (!prediction.rows)
    for (double& t : time) t /= prediction.time_scale;
  bool const has_noise = !noisy_lower.empty(), has_data = !measured.empty();
  bool const has_band = has_noise || quantity.response.draws != 1;  // an optimum is one trajectory

  double const point_size = time.size() > 100 ? 0.24 : 0.5;
  std::vector<Key> keys;
  if (has_data) keys.push_back({Key::points, data, "measured"});
  keys.push_back({Key::line, model, has_band ? "mean" : "model"});
  if (has_band) keys.push_back({Key::area, response_band, "95 % band"});
  if (has_noise) keys.push_back({Key::area, noise_band, "with noise"});
  int const width = column_width, left = 70, right = width - 14;
  int const legend_rows = legend_height(keys, 10, right);
  int const height = (has_data ? 330 : 200) + legend_rows;
  Axis x = axis(time.front(), time.back(), 6);
  x.reach_ticks();
  std::pair<double, double> extent = finite_range(mean);
  for (auto const* series : {&lower, &upper, &noisy_lower, &noisy_upper, &measured})
    if (!series->empty()) extent = cover(extent, finite_range(*series));
  Axis const y = axis(extent.first, extent.second, 5, 0.04);

  Figure out;
  out.topic = Topic::fit;
  out.name = figure_name(has_data ? "fit" : "state", prediction, quantity);
  out.title = fmt::format("{} on {}", quantity.name, prediction.experiment);
  out.script = preamble(out.name, width, height);
  std::vector<std::vector<double>> rows, residual_rows;
  std::pair<double, double> residual_extent(0, 0);
  for (std::size_t i = 0; i < time.size(); ++i) {
    double const nan = std::nan("");
    auto const at = [&](std::vector<double> const& series) { return series.empty() ? nan : y.scaled(series[i]); };
    rows.push_back({x.scaled(time[i]), at(mean), at(lower), at(upper), at(noisy_lower), at(noisy_upper), at(measured)});
    if (!has_data) continue;
    double const low = has_noise ? noisy_lower[i] - mean[i] : lower[i] - mean[i];
    double const high = has_noise ? noisy_upper[i] - mean[i] : upper[i] - mean[i];
    residual_rows.push_back({x.scaled(time[i]), measured[i] - mean[i], low, high});
    for (double const v : {measured[i] - mean[i], low, high})
      if (std::isfinite(v)) residual_extent = cover(residual_extent, {v, v});
  }
  out.script += data_block("fit", rows);

  Panel top = panel_at(left, right, has_data ? 146.0 : 44.0, height - 12.0 - legend_rows, x, y);
  top.x_label = has_data ? "" : axis_label(prediction.rows ? "row" : "time", prediction.rows ? "" : prediction.time_unit, x);
  top.x_numbers = !has_data;
  top.y_label = axis_label(quantity.name, quantity.unit, y);
  out.script += panel(top, width, height);
  out.script += legend(keys, 10, top.right, height - 12.0, width, height);
  out.script += "plot ";
  if (has_noise) out.script += fmt::format("$fit using 1:5:6 with filledcurves fc rgb '{}' fs noborder, ", noise_band);
  out.script += fmt::format("$fit using 1:3:4 with filledcurves fc rgb '{}' fs noborder, ", response_band);
  if (has_data) out.script += fmt::format("$fit using 1:7 with points pt 7 ps {} lc rgb '{}', ", point_size, data);
  out.script += fmt::format("$fit using 1:2 with lines lw 1.4 lc rgb '{}'\n", model);

  out.script += end_legend();

  if (has_data) {
    Axis const r = axis(residual_extent.first, residual_extent.second, 3, 0.06);
    for (auto& row : residual_rows)
      for (std::size_t c = 1; c < row.size(); ++c) row[c] = r.scaled(row[c]);
    out.script += data_block("residual", residual_rows);
    Panel low = panel_at(top.left, top.right, 44, 128, x, r);
    low.x_label = axis_label(prediction.rows ? "row" : "time", prediction.rows ? "" : prediction.time_unit, x);
    low.y_label = axis_label("residual", quantity.unit, r);
    low.y_label_room = 136;
    out.script += panel(low, width, height);
    out.script += fmt::format(
        "plot $residual using 1:3:4 with filledcurves fc rgb '{}' fs noborder, "
        "0 with lines lw 1 lc rgb '{}', $residual using 1:2 with points pt 7 ps {} lc rgb '{}'\n",
        has_noise ? noise_band : response_band, model, point_size, data);
  }
  out.script += "unset multiplot\n";

  if (has_data)
    out.caption = fmt::format(
        "Measured and modelled {}. The residuals below should show no pattern; {}", quantity.name,
        has_noise  ? "about 5 % lie outside the light band, which includes the noise; the darker band is that of the response."
        : has_band ? "the band is that of the response, without noise."
                   : "a single trajectory has no band.");
  else
    out.caption =
        fmt::format("The prediction of {}, which is not measured{}.", quantity.name, has_band ? ", with its 95 % band" : "");
  if (!w.whole) {
    auto const begin = prediction.scored.begin() + static_cast<std::ptrdiff_t>(w.first);
    out.caption += fmt::format(" Shown are the first {} of {} scored samples.",
                               std::count(begin, begin + static_cast<std::ptrdiff_t>(w.count), 1),
                               std::count(prediction.scored.begin(), prediction.scored.end(), 1));
  }
  return out;
}

}  // namespace sysid
