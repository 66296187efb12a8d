// Where rows are independent: a measured quantity over each input, with the bands of the model.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "report/figure/figures.hpp"

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

}  // namespace

bool over_inputs(Prediction const& prediction, PredictedQuantity const& quantity) {
  return prediction.rows && !quantity.measured.empty() && quantity.response.mean.size() == prediction.time.size() &&
         prediction.time.size() > 2 && !varying(prediction).empty();
}

Figure input_figure(Prediction const& prediction, PredictedQuantity const& quantity) {
  std::vector<PredictedInput const*> inputs = varying(prediction);
  std::size_t const all = inputs.size();
  inputs.resize(std::min(all, shown_inputs));
  bool const curve = prediction.inputs.size() == 1, has_noise = !quantity.noisy.lower.empty();
  Band const& band = has_noise ? quantity.noisy : quantity.response;
  bool const has_band = has_noise || quantity.response.draws != 1;

  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < prediction.time.size(); ++i)
    if (prediction.scored[i] != 0) rows.push_back(i);
  if (rows.empty()) {
    rows.resize(prediction.time.size());
    std::iota(rows.begin(), rows.end(), std::size_t{0});
  }
  std::size_t const scored = rows.size(), stride = curve ? 1 : (scored + shown_rows - 1) / shown_rows;
  if (stride > 1) {
    std::vector<std::size_t> thinned;
    for (std::size_t r = 0; r < rows.size(); r += stride) thinned.push_back(rows[r]);
    rows = std::move(thinned);
  }

  std::pair<double, double> extent = finite_range(quantity.measured);
  for (auto const* series : {&band.lower, &band.upper, &quantity.response.mean})
    if (!series->empty()) extent = cover(extent, finite_range(*series));
  Axis const y = axis(extent.first, extent.second, 5, 0.04);
  std::vector<Key> keys = {{Key::points, data, "measured"}, {curve ? Key::line : Key::points, model, has_band ? "mean" : "model"}};
  if (curve && has_band) keys.push_back({Key::area, response_band, "95 % band"});
  if (has_noise) keys.push_back({Key::area, noise_band, curve && has_band ? "with noise" : "95 % with noise"});
  if (!curve && has_band && !has_noise) keys.push_back({Key::area, response_band, "95 % band"});
  int const width = column_width, legend_rows = legend_height(keys, 10, width - 14), height = 246 + legend_rows;
  Figure out;
  out.topic = Topic::fit;
  out.name = identifier(fmt::format("inputs_{}_{}", prediction.experiment, quantity.name));
  out.title = fmt::format("{} over the input{}", quantity.name, all == 1 ? "" : "s");
  out.script = preamble(out.name, width, height) + legend(keys, 10, width - 14.0, height - 12.0, width, height);
  double const step = (width - 70.0) / static_cast<double>(inputs.size());
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    PredictedInput const& input = *inputs[k];
    std::vector<std::size_t> order = rows;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return input.values[a] < input.values[b]; });
    auto const [low, high] = finite_range(input.values);
    Axis const x = axis(low, high, inputs.size() == 1 ? 6 : 3, 0.02);
    double const left = 70 + static_cast<double>(k) * step;
    Panel p = panel_at(left, k + 1 == inputs.size() ? width - 14.0 : left + step - 30, 44, height - 12.0 - legend_rows, x, y);
    p.x_label = axis_label(input.name, input.unit, x);
    p.y_numbers = k == 0;
    if (k == 0) p.y_label = axis_label(quantity.name, quantity.unit, y);
    std::vector<std::vector<double>> table;
    for (std::size_t const i : order) {
      auto const at = [&](std::vector<double> const& series) { return series.empty() ? std::nan("") : y.scaled(series[i]); };
      table.push_back({x.scaled(input.values[i]), at(quantity.response.mean), at(quantity.response.lower),
                       at(quantity.response.upper), at(quantity.noisy.lower), at(quantity.noisy.upper), at(quantity.measured)});
    }
    std::string const name = fmt::format("input{}", k);
    out.script += data_block(name, table) + panel(p, width, height);
    std::string plots;
    auto const add = [&](std::string const& what) {
      plots += fmt::format("{}${} using {}", plots.empty() ? "plot " : ", ", name, what);
    };
    if (curve && has_noise) add(fmt::format("1:5:6 with filledcurves fc rgb '{}' fs noborder", noise_band));
    if (curve && has_band) add(fmt::format("1:3:4 with filledcurves fc rgb '{}' fs noborder", response_band));
    // What the other inputs do stands beside: no curve, a bar for each row.
    if (!curve && has_band)
      add(fmt::format("1:{}:(0):(${}-${}) with vectors nohead lw 2.4 lc rgb '{}'", has_noise ? 5 : 3, has_noise ? 6 : 4,
                      has_noise ? 5 : 3, has_noise ? noise_band : response_band));
    add(fmt::format("1:7 with points pt 7 ps 0.3 lc rgb '{}'", data));
    add(curve ? fmt::format("1:2 with lines lw 1.6 lc rgb '{}'", model)
              : fmt::format("1:2 with points pt 7 ps 0.22 lc rgb '{}'", model));
    out.script += plots + '\n';
    if (k == 0) out.script += end_legend();
  }
  out.script += "unset multiplot\n";
  out.caption = fmt::format("Measured and modelled {} over {}{}.", quantity.name, all == 1 ? inputs[0]->name : "each input",
                            has_noise  ? ", with the band that holds 95 % of the measurements"
                            : has_band ? ", with the 95 % band of the response"
                                       : "");
  if (!curve) out.caption += " At one value of an input the other inputs differ from row to row, so each row has a bar of its own.";
  if (stride > 1) out.caption += fmt::format(" One row in {} is shown.", stride);
  if (all > inputs.size()) out.caption += fmt::format(" Shown are the first {} of {} inputs.", inputs.size(), all);
  return out;
}

}  // namespace sysid
