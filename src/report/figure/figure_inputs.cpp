// Where rows are independent: a measured quantity over each input, with the bands of the model.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "report/figure/drawing.hpp"
#include "report/figure/figures.hpp"
#include "report/figure/small_multiples.hpp"

namespace sysid {

namespace {

using namespace plot;

constexpr std::size_t shown_inputs = 3;
/// More bars than this side by side are a blot.
constexpr std::size_t shown_rows = 240;

std::vector<PredictedInput const*> varying(Prediction const& prediction) {
  std::vector<PredictedInput const*> out;
  for (PredictedInput const& input : prediction.inputs) {
    auto const [low, high] = finite_range(input.values);
    if (input.values.size() == prediction.time.size() && high > low) out.push_back(&input);
  }
  return out;
}

/// Scored rows, or all where none is; of many one in `stride`.
struct ShownRows {
  std::vector<std::size_t> rows;
  std::size_t stride = 1;
};

ShownRows shown_of(Prediction const& prediction, bool curve) {
  ShownRows out;
  for (std::size_t i = 0; i < prediction.time.size(); ++i)
    if (prediction.scored[i] != 0) out.rows.push_back(i);
  if (out.rows.empty()) {
    out.rows.resize(prediction.time.size());
    std::iota(out.rows.begin(), out.rows.end(), std::size_t{0});
  }
  if (!curve) out.stride = (out.rows.size() + shown_rows - 1) / shown_rows;
  if (out.stride == 1) return out;
  std::vector<std::size_t> thinned;
  for (std::size_t r = 0; r < out.rows.size(); r += out.stride) thinned.push_back(out.rows[r]);
  out.rows = std::move(thinned);
  return out;
}

/// How the model is shown. At one place of an input the others differ from row to row: then there is no curve, a bar for each row.
struct Style {
  bool curve, has_noise, has_band;

  Style(Prediction const& prediction, PredictedQuantity const& quantity)
      : curve(prediction.inputs.size() == 1),
        has_noise(!quantity.noisy.lower.empty()),
        has_band(has_noise || quantity.response.draws != 1) {}
};

Axis value_axis(PredictedQuantity const& quantity, Style const& style) {
  Band const& band = style.has_noise ? quantity.noisy : quantity.response;
  std::pair<double, double> extent = finite_range(quantity.measured);
  for (auto const* series : {&band.lower, &band.upper, &quantity.response.mean})
    if (!series->empty()) extent = cover(extent, finite_range(*series));
  return axis(extent.first, extent.second, 5, 0.04);
}

std::vector<Key> keys_of(Style const& style) {
  auto const [curve, has_noise, has_band] = style;
  std::vector<Key> keys = {{Key::points, data, "measured"}, {curve ? Key::line : Key::circles, model, has_band ? "mean" : "model"}};
  if (curve && has_band) keys.push_back({Key::area, response_band, "95 % band"});
  if (has_noise) keys.push_back({Key::area, noise_band, curve && has_band ? "with noise" : "95 % with noise"});
  if (!curve && has_band && !has_noise) keys.push_back({Key::area, response_band, "95 % band"});
  return keys;
}

/// All series over one input, its values rising.
Rows rows_over(PredictedInput const& input, PredictedQuantity const& quantity, std::vector<std::size_t> order, Axis const& x,
               Axis const& y) {
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return input.values[a] < input.values[b]; });
  Rows rows;
  for (std::size_t const i : order) {
    auto const at = [&](std::vector<double> const& series) { return series.empty() ? std::nan("") : y.scaled(series[i]); };
    rows.push_back({x.scaled(input.values[i]), at(quantity.response.mean), at(quantity.response.lower), at(quantity.response.upper),
                    at(quantity.noisy.lower), at(quantity.noisy.upper), at(quantity.measured)});
  }
  return rows;
}

std::vector<Series> series_of(Style const& style, std::string const& table) {
  std::vector<Series> out;
  if (style.curve && style.has_noise) out.push_back(band(table, 5, 6, noise_band));
  if (style.curve && style.has_band) out.push_back(band(table, 3, 4, response_band));
  if (!style.curve && style.has_band)
    out.push_back(style.has_noise ? upright_bars(table, 5, 6, noise_band) : upright_bars(table, 3, 4, response_band));
  out.push_back(points(table, 7, 0.3, data));
  out.push_back(style.curve ? line(table, 2, 1.6, model) : circles(table, 2, 0.5, model));
  return out;
}

std::string caption_of(Style const& style, std::string const& quantity, std::string_view where, std::string const& over) {
  std::string out = fmt::format("Measured and modelled {}{} over {}{}.", quantity, where, over,
                                style.has_noise  ? ", with the band that should contain 95 % of the measurements"
                                : style.has_band ? ", with the 95 % band of the response"
                                                 : "");
  if (!style.curve) out += " At one value of an input the other inputs differ from row to row, so each row has a bar of its own.";
  return out;
}

}  // namespace

bool over_inputs(Prediction const& prediction, PredictedQuantity const& quantity) {
  return prediction.rows && !quantity.measured.empty() && quantity.response.mean.size() == prediction.time.size() &&
         prediction.time.size() > 2 && !varying(prediction).empty();
}

Figure input_figure(Prediction const& prediction, PredictedQuantity const& quantity, std::string_view where) {
  std::vector<PredictedInput const*> inputs = varying(prediction);
  std::size_t const all = inputs.size();
  inputs.resize(std::min(all, shown_inputs));
  Style const style(prediction, quantity);
  ShownRows const shown = shown_of(prediction, style.curve);
  Axis const y = value_axis(quantity, style);

  Legend legend{keys_of(style)};
  int const legend_rows = legend.height(), height = 246 + legend_rows;
  Drawing drawing{identifier(fmt::format("inputs_{}_{}", prediction.experiment, quantity.name)), column_width, height,
                  std::move(legend)};
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    PredictedInput const& input = *inputs[k];
    auto const [low, high] = finite_range(input.values);
    Panel p =
        panel_beside(k, inputs.size(), 14, 44, height - 12.0 - legend_rows, axis(low, high, inputs.size() == 1 ? 6 : 3, 0.02), y);
    p.x_label = axis_label(input.name, input.unit, p.x);
    p.y_numbers = k == 0;
    if (k == 0) p.y_label = axis_label(quantity.name, quantity.unit, y);
    std::string const table = fmt::format("input{}", k);
    Rows rows = rows_over(input, quantity, shown.rows, p.x, y);
    drawing.plots.push_back({std::move(p), {{table, std::move(rows)}}, series_of(style, table)});
  }
  Figure out{drawing.name, fmt::format("{} over the input{}", quantity.name, all == 1 ? "" : "s"),
             caption_of(style, quantity.name, where, all == 1 ? inputs[0]->name : "each input"), script(drawing), Topic::fit};
  if (shown.stride > 1) out.caption += fmt::format(" One row in {} is shown.", shown.stride);
  if (all > inputs.size()) out.caption += fmt::format(" Shown are the first {} of {} inputs.", inputs.size(), all);
  return out;
}

}  // namespace sysid
