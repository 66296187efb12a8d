// A long record as a whole: between the least and the largest value in each of some hundred stretches of rows.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/text/number.hpp"
#include "report/figure/drawing.hpp"
#include "report/figure/figures.hpp"
#include "report/text/report_text.hpp"

namespace sysid {

namespace {

using namespace plot;

constexpr std::size_t most_stretches = 300;  // more are narrower than a pixel of print

/// Least and largest of what is added; NaN where nothing is.
struct Range {
  double low = std::nan(""), high = std::nan("");
  void add(double value) {
    if (!std::isfinite(value)) return;
    low = std::isnan(low) ? value : std::min(low, value);
    high = std::isnan(high) ? value : std::max(high, value);
  }
};

struct Stretch {
  double time = 0;
  Range measured, model, residual, noise;
};

struct Whole {
  std::vector<Stretch> stretches;
  double worst = 0, worst_time = 0;  // the largest residual

  Whole(Prediction const& prediction, PredictedQuantity const& quantity) {
    auto const first =
        static_cast<std::size_t>(std::find(prediction.scored.begin(), prediction.scored.end(), 1) - prediction.scored.begin());
    std::size_t const rows = prediction.time.size() - first;
    double const scale = prediction.rows ? 1 : prediction.time_scale;
    bool const noisy = !quantity.noisy.lower.empty();
    for (std::size_t s = 0; s < most_stretches; ++s) {
      std::size_t const from = first + s * rows / most_stretches, to = first + (s + 1) * rows / most_stretches;
      Stretch stretch;
      stretch.time = (prediction.time[from] + prediction.time[to - 1]) / 2 / scale;
      for (std::size_t i = from; i < to; ++i) {
        if (prediction.scored[i] == 0) continue;
        double const mean = quantity.response.mean[i], residual = quantity.measured[i] - mean;
        stretch.measured.add(quantity.measured[i]);
        stretch.model.add(mean);
        stretch.residual.add(residual);
        if (noisy) stretch.noise.add(quantity.noisy.lower[i] - mean), stretch.noise.add(quantity.noisy.upper[i] - mean);
        if (std::abs(residual) > std::abs(worst)) worst = residual, worst_time = prediction.time[i] / scale;
      }
      stretches.push_back(stretch);
    }
  }

  Axis axis_of(std::initializer_list<Range Stretch::*> ranges, int ticks) const {
    Range all;
    for (Stretch const& each : stretches)
      for (auto const range : ranges) all.add((each.*range).low), all.add((each.*range).high);
    return axis(all.low, all.high, ticks, 0.05);
  }

  Rows rows(Axis const& x, Axis const& y, std::initializer_list<Range Stretch::*> ranges) const {
    Rows out;
    for (Stretch const& each : stretches) {
      std::vector<double> row = {x.scaled(each.time)};
      for (auto const range : ranges) row.push_back(y.scaled((each.*range).low)), row.push_back(y.scaled((each.*range).high));
      out.push_back(std::move(row));
    }
    return out;
  }
};

}  // namespace

bool is_long(Prediction const& prediction, PredictedQuantity const& quantity) {
  return !prediction.rows && !quantity.measured.empty() && quantity.response.mean.size() == prediction.time.size() &&
         std::count(prediction.scored.begin(), prediction.scored.end(), 1) > static_cast<std::ptrdiff_t>(shown_samples) &&
         std::any_of(quantity.measured.begin(), quantity.measured.end(), [](double each) { return std::isfinite(each); });
}

Figure whole_figure(Prediction const& prediction, PredictedQuantity const& quantity, std::string_view where) {
  Whole const whole(prediction, quantity);
  bool const noisy = !quantity.noisy.lower.empty();
  Legend legend{{{Key::area, muted, "measured"}, {Key::line, model, "model"}}};
  if (noisy) legend.keys.push_back({Key::area, noise_band, "95 % with noise"});
  legend.after_first_panel = true;
  int const left = 70, right = column_width - 14, legend_rows = legend.height();
  Drawing drawing{identifier(fmt::format("whole_{}_{}", prediction.experiment, quantity.name)), column_width, 330 + legend_rows,
                  std::move(legend)};
  Axis x = axis(whole.stretches.front().time, whole.stretches.back().time, 6);
  x.reach_ticks();

  Panel top =
      panel_at(left, right, 146, drawing.height - 12.0 - legend_rows, x, whole.axis_of({&Stretch::measured, &Stretch::model}, 5));
  top.x_numbers = false;
  top.y_label = axis_label(quantity.name, quantity.unit, top.y);
  Rows above = whole.rows(x, top.y, {&Stretch::measured, &Stretch::model});
  drawing.plots.push_back({std::move(top),
                           {{"whole", std::move(above)}},
                           {band("whole", 2, 3, muted), line("whole", 4, 1, model), line("whole", 5, 1, model)}});

  Panel below = panel_at(left, right, 44, 128, x, whole.axis_of({&Stretch::residual, &Stretch::noise}, 3));
  below.x_label = axis_label("time", prediction.time_unit, x);
  below.y_label = axis_label("residual", quantity.unit, below.y);
  below.y_label_room = 136;
  Rows residuals = whole.rows(x, below.y, {&Stretch::residual, &Stretch::noise});
  std::vector<Series> series = {band("residuals", 2, 3, muted), level(0, model)};
  if (noisy) series.insert(series.begin(), band("residuals", 4, 5, noise_band));
  drawing.plots.push_back({std::move(below), {{"residuals", std::move(residuals)}}, std::move(series)});
  return {drawing.name, fmt::format("{} on {}, the whole record", quantity.name, prediction.experiment),
          fmt::format(
              "The whole record of {}{}, divided into {} intervals. Above: for each interval the range of the measured samples "
              "(band) and of the model (between the lines). Below: the range of the residuals. The largest residual, {}, is at {}.",
              quantity.name, where, whole.stretches.size(), quantity_text(whole.worst, 3, quantity.unit),
              quantity_text(whole.worst_time, 5, prediction.time_unit)),
          script(drawing), Topic::fit};
}

}  // namespace sysid
