// Figures along the record: fit or prediction with bands and residuals.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/text/number.hpp"
#include "report/figure/drawing.hpp"
#include "report/figure/figures.hpp"

namespace sysid {

namespace {

using namespace plot;

constexpr double line_width = 1.4;

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

/// The part of a quantity's series that is shown; empty where there is no such series.
struct Excerpt {
  std::vector<double> time, mean, lower, upper, noisy_lower, noisy_upper, measured;
  bool has_noise, has_data, has_band;

  Excerpt(Prediction const& prediction, PredictedQuantity const& quantity, Window w)
      : time(cut(prediction.time, w)),
        mean(cut(quantity.response.mean, w)),
        lower(cut(quantity.response.lower, w)),
        upper(cut(quantity.response.upper, w)),
        noisy_lower(cut(quantity.noisy.lower, w)),
        noisy_upper(cut(quantity.noisy.upper, w)),
        measured(cut(quantity.measured, w)),
        has_noise(!noisy_lower.empty()),
        has_data(!measured.empty()),
        has_band(has_noise || prediction.smoothed || quantity.response.draws != 1) {  // an optimum is one trajectory
    if (!prediction.rows)
      for (double& t : time) t /= prediction.time_scale;
  }

  double point_size() const { return time.size() > 100 ? 0.24 : 0.5; }
};

std::vector<Key> keys_of(Excerpt const& of, bool alarms) {
  std::vector<Key> keys;
  if (of.has_data) keys.push_back({Key::points, data, "measured"});
  keys.push_back({Key::line, model, of.has_band ? "mean" : "model"});
  if (of.has_band) keys.push_back({Key::area, response_band, "95 % band"});
  if (of.has_noise) keys.push_back({Key::area, noise_band, "with noise"});
  if (alarms) keys.push_back({Key::line, contrast, "change found"});
  return keys;
}

Axis value_axis(Excerpt const& of) {
  std::pair<double, double> extent = finite_range(of.mean);
  for (auto const* series : {&of.lower, &of.upper, &of.noisy_lower, &of.noisy_upper, &of.measured})
    if (!series->empty()) extent = cover(extent, finite_range(*series));
  return axis(extent.first, extent.second, 5, 0.04);
}

std::string time_label(Prediction const& prediction, Axis const& x) {
  return axis_label(prediction.rows ? "row" : "time", prediction.rows ? "" : prediction.time_unit, x);
}

Rows fit_rows(Excerpt const& of, Axis const& x, Axis const& y) {
  Rows rows;
  for (std::size_t i = 0; i < of.time.size(); ++i) {
    auto const at = [&](std::vector<double> const& series) { return series.empty() ? std::nan("") : y.scaled(series[i]); };
    rows.push_back(
        {x.scaled(of.time[i]), at(of.mean), at(of.lower), at(of.upper), at(of.noisy_lower), at(of.noisy_upper), at(of.measured)});
  }
  return rows;
}

/// The series along the record, in the panel.
Plot fit_plot(Excerpt const& of, Panel panel) {
  Plot out{std::move(panel)};
  out.tables = {{"fit", fit_rows(of, out.panel.x, out.panel.y)}};
  if (of.has_noise) out.series.push_back(band("fit", 5, 6, noise_band));
  out.series.push_back(band("fit", 3, 4, response_band));
  if (of.has_data) out.series.push_back(points("fit", 7, of.point_size(), data));
  out.series.push_back(line("fit", 2, line_width, model));
  return out;
}

/// Upright lines where a change was found.
void add_alarms(std::vector<double> const& alarms, double time_scale, Plot& plot) {
  Panel const& panel = plot.panel;
  for (std::size_t i = 0; i < alarms.size(); ++i) {
    double const at = panel.x.scaled(alarms[i] / time_scale);
    if (!(at >= panel.x.low && at <= panel.x.high)) continue;
    plot.tables.push_back({fmt::format("alarm{}", i), {{at, panel.y.low}, {at, panel.y.high}}});
    plot.series.push_back(line(plot.tables.back().name, 2, 1.2, contrast));
  }
}

/// Measured minus mean, with the band about 0. The panel's ordinate is made here.
Plot residual_plot(Excerpt const& of, std::string const& unit, Panel panel) {
  Rows rows;
  std::pair<double, double> extent(0, 0);
  for (std::size_t i = 0; i < of.time.size(); ++i) {
    double const low = (of.has_noise ? of.noisy_lower[i] : of.lower[i]) - of.mean[i];
    double const high = (of.has_noise ? of.noisy_upper[i] : of.upper[i]) - of.mean[i];
    rows.push_back({panel.x.scaled(of.time[i]), of.measured[i] - of.mean[i], low, high});
    for (double const v : {of.measured[i] - of.mean[i], low, high})
      if (std::isfinite(v)) extent = cover(extent, {v, v});
  }
  panel.y = axis(extent.first, extent.second, 3, 0.06);
  panel.y_label = axis_label("residual", unit, panel.y);
  panel.y_label_room = 136;
  for (auto& row : rows)
    for (std::size_t c = 1; c < row.size(); ++c) row[c] = panel.y.scaled(row[c]);
  return {std::move(panel),
          {{"residual", std::move(rows)}},
          {band("residual", 3, 4, of.has_noise ? noise_band : response_band), level(0, model),
           points("residual", 2, of.point_size(), data)}};
}

std::string caption_of_smoothed(PredictedQuantity const& quantity, std::string_view where) {
  return fmt::format(
      "{}{} given all samples of the record, with its 95 % band, which includes the uncertainty of states and parameters{}.",
      quantity.name, where, quantity.average ? "; the value at each sample is the mean from there to the next" : "");
}

/// "deflection" of "white(deflection)": what the model says of a channel without its Gaussian processes.
std::optional<std::string> parametric_part(std::string const& name) {
  constexpr std::string_view open = "white(";
  if (!name.starts_with(open) || !name.ends_with(')')) return std::nullopt;
  return name.substr(open.size(), name.size() - open.size() - 1);
}

std::string caption_of(Excerpt const& of, std::string const& name, std::string_view where) {
  if (!of.has_data) {
    std::string const band = of.has_band ? ", with its 95 % band" : "";
    if (auto const channel = parametric_part(name))
      return fmt::format("The parametric part of {}{}: what the model predicts with every Gaussian process at zero{}.", *channel,
                         where, band);
    return fmt::format("The prediction of {}{}, which is not measured{}.", name, where, band);
  }
  return fmt::format(
      "Measured and modelled {}{}. The residuals below should show no pattern; {}", name, where,
      of.has_noise  ? "about 5\u00a0% lie outside the wide band, which includes the noise; the narrow band is that of the response."
      : of.has_band ? "the band is that of the response, without noise."
                    : "a single trajectory has no band.");
}

/// Of a figure without residuals: how wide its band is where the line covers all of it; else empty.
std::string thin_band(Excerpt const& of, std::string const& unit, Panel const& panel) {
  if (of.has_data || !of.has_band) return "";
  double widest = 0;
  for (std::size_t i = 0; i < of.mean.size(); ++i)
    if (double const width = of.upper[i] - of.lower[i]; std::isfinite(width)) widest = std::max(widest, width);
  double const pixels = panel.y.scaled_width(widest) / (panel.y.high - panel.y.low) * (panel.top - panel.bottom);
  if (!(widest > 0) || pixels > line_width) return "";
  return fmt::format(" The band is at most {}{} wide, too narrow to be seen beside the line.",
                     pretty_number(significant(widest, 2)), unit_after_number(unit));
}

std::string samples_excluded(Prediction const& prediction, Window w) {
  if (w.whole) return "";
  auto const begin = prediction.scored.begin() + static_cast<std::ptrdiff_t>(w.first);
  return fmt::format(" Shown are the first {} of {} scored samples.",
                     std::count(begin, begin + static_cast<std::ptrdiff_t>(w.count), 1),
                     std::count(prediction.scored.begin(), prediction.scored.end(), 1));
}

}  // namespace

namespace {

Figure along_record(Prediction const& prediction, PredictedQuantity const& quantity, std::string_view kind,
                    std::string_view where) {
  Window const w = window(prediction);
  Excerpt const of(prediction, quantity, w);
  Legend legend{keys_of(of, !quantity.alarms.empty())};
  legend.after_first_panel = true;
  int const left = 70, right = column_width - 14, legend_rows = legend.height();
  Drawing drawing{figure_name(kind, prediction, quantity), column_width, (of.has_data ? 330 : 200) + legend_rows,
                  std::move(legend)};
  Axis x = axis(of.time.front(), of.time.back(), 6);
  x.reach_ticks();

  Panel top = panel_at(left, right, of.has_data ? 146.0 : 44.0, drawing.height - 12.0 - legend_rows, x, value_axis(of));
  top.x_numbers = !of.has_data;
  if (top.x_numbers) top.x_label = time_label(prediction, x);
  auto const part = parametric_part(quantity.name);
  top.y_label = axis_label(part ? *part + ", parametric" : quantity.name, quantity.unit, top.y);
  std::string const thin = thin_band(of, quantity.unit, top);
  drawing.plots.push_back(fit_plot(of, std::move(top)));
  add_alarms(quantity.alarms, prediction.rows ? 1 : prediction.time_scale, drawing.plots.back());
  if (of.has_data) {
    Panel below = panel_at(left, right, 44, 128, x, {});
    below.x_label = time_label(prediction, x);
    drawing.plots.push_back(residual_plot(of, quantity.unit, std::move(below)));
  }
  std::string const caption = prediction.smoothed ? caption_of_smoothed(quantity, where) : caption_of(of, quantity.name, where);
  return {drawing.name,
          fmt::format("{}{} on {}", part ? "parametric part of " + *part : quantity.name, prediction.smoothed ? ", smoothed," : "",
                      prediction.experiment),
          caption + thin + samples_excluded(prediction, w), script(drawing), prediction.smoothed ? Topic::states : Topic::fit};
}

}  // namespace

Figure fit_figure(Prediction const& prediction, PredictedQuantity const& quantity, std::string_view where) {
  return along_record(prediction, quantity, prediction.smoothed ? "smoothed" : !quantity.measured.empty() ? "fit" : "state", where);
}

Figure free_run_figure(Prediction const& run, PredictedQuantity const& quantity) {
  Figure figure = along_record(run, quantity, "free_run", {});
  auto const start = std::find(run.scored.begin(), run.scored.end(), 1) - run.scored.begin();
  std::vector<double> const& mean = quantity.response.mean;
  std::string caption = fmt::format(
      "Measured {} and a free run of the equations found. Its start is estimated from the {} rows before; no later measurement is "
      "used{}.",
      quantity.name, start, run.inputs.empty() ? "" : ", except the inputs");
  if (!mean.empty() && !std::isfinite(mean.back()))
    caption += " It is shown until it leaves ten times the range of the measurements.";
  figure.caption = caption + samples_excluded(run, window(run));
  return figure;
}

}  // namespace sysid
