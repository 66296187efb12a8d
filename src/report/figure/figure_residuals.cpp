// The residuals of a channel: their autocorrelation, and their correlation with earlier values of each input.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnostics/residuals/residual_tests.hpp"
#include "report/figure/drawing.hpp"
#include "report/figure/figures.hpp"

namespace sysid {

namespace {

using namespace plot;

constexpr std::size_t most_crossed = 3;
constexpr int most_lags = 60;
/// Of fewer the correlations say nothing.
constexpr std::ptrdiff_t least_residuals = 20;

/// Measured minus modelled at the scored samples, NaN elsewhere.
std::vector<double> residuals_of(Prediction const& prediction, PredictedQuantity const& quantity) {
  std::vector<double> out;
  for (std::size_t i = 0; i < quantity.measured.size() && i < quantity.response.mean.size(); ++i)
    out.push_back(prediction.scored[i] != 0 ? quantity.measured[i] - quantity.response.mean[i] : std::nan(""));
  return out;
}

std::ptrdiff_t number_of(std::vector<double> const& residuals) {
  return std::count_if(residuals.begin(), residuals.end(), [](double residual) { return std::isfinite(residual); });
}

/// One panel: the correlations of a test with what is written beside them.
struct Correlations {
  CorrelationTest test;
  std::string label, name;
};

/// Correlations with inputs: those shown, and how many are not, for their number or because the input does not vary.
struct Crossed {
  std::vector<Correlations> shown;
  std::size_t hidden = 0, constant = 0;
};

Crossed crossed_with_inputs(Prediction const& prediction, std::vector<double> const& residuals, int lags) {
  Crossed out;
  if (prediction.rows) return out;  // rows of any order have no input before them
  for (std::size_t k = 0; k < prediction.inputs.size(); ++k) {
    PredictedInput const& input = prediction.inputs[k];
    Correlations each{input_correlation(residuals, input.values, lags), "with " + input.name, fmt::format("input{}", k)};
    std::vector<double> const& found = each.test.correlation;
    if (!found.empty() && std::all_of(found.begin(), found.end(), [](double one) { return std::isfinite(one); }))
      out.shown.push_back(std::move(each));
    else
      ++out.constant;
  }
  if (out.shown.size() <= most_crossed) return out;
  out.hidden = out.shown.size() - most_crossed;
  out.shown.resize(most_crossed);
  return out;
}

Plot correlation_plot(Correlations const& of, Panel panel, int lags, std::string_view colour) {
  std::vector<double> all = of.test.correlation;
  Rows bars, limits;
  for (std::size_t i = 0; i < of.test.correlation.size(); ++i) {
    double const lag = of.test.first_lag + static_cast<double>(i);
    bars.push_back({lag, of.test.correlation[i]});
    limits.push_back({lag, -of.test.bound[i], of.test.bound[i]});
    for (double const factor : {-1.5, 1.5}) all.push_back(factor * of.test.bound[i]);
  }
  // The band ends with the panel, not with the last lag.
  limits.insert(limits.begin(), {-0.5, limits.front()[1], limits.front()[2]});
  limits.push_back({lags + 1.0, limits.back()[1], limits.back()[2]});
  auto const [low, high] = finite_range(all);
  panel.x = axis(-0.5, lags + 1, 7);
  panel.x.exponent = 0;
  panel.y = axis(std::min(low, 0.0), std::max(high, 0.0), 3, 0.05);
  panel.y_label = axis_label(of.label, "", panel.y);
  for (auto& row : bars) row[1] = panel.y.scaled(row[1]);
  for (auto& row : limits)
    for (std::size_t c : {1U, 2U}) row[c] = panel.y.scaled(row[c]);
  std::string const limit = of.name + "_limit";
  return {std::move(panel),
          {{of.name, std::move(bars)}, {limit, std::move(limits)}},
          {band(limit, 2, 3, noise_band), level(0, muted), impulses(of.name, colour)}};
}

}  // namespace

bool has_residuals(Prediction const& prediction, PredictedQuantity const& quantity) {
  std::vector<double> const residuals = residuals_of(prediction, quantity);
  return number_of(residuals) >= least_residuals && !whiteness(residuals, 1).correlation.empty();
}

Figure residual_figure(Prediction const& prediction, PredictedQuantity const& quantity, std::string_view where) {
  std::vector<double> const residuals = residuals_of(prediction, quantity);
  Correlations const own{whiteness(residuals, most_lags), "autocorrelation", "acf"};
  int const lags = static_cast<int>(own.test.correlation.size());
  Crossed const crossed = crossed_with_inputs(prediction, residuals, lags);

  constexpr int each = 118, below = 44;
  Drawing drawing{identifier(fmt::format("residuals_{}_{}", prediction.experiment, quantity.name)), column_width,
                  below + each * (1 + static_cast<int>(crossed.shown.size()))};
  int top = drawing.height - 10;
  auto const add = [&](Correlations const& shown, bool last, std::string_view colour) {
    Panel panel = panel_at(70, column_width - 14.0, top - each + 22.0, top, {}, {});
    top -= each;
    panel.x_numbers = last;
    if (last) panel.x_label = prediction.rows ? "lag [rows]" : "lag [samples]";
    drawing.plots.push_back(correlation_plot(shown, std::move(panel), lags, colour));
  };
  add(own, crossed.shown.empty(), model);
  for (Correlations const& shown : crossed.shown) add(shown, &shown == &crossed.shown.back(), contrast);
  Figure out{drawing.name, fmt::format("Correlations of the residuals of {}", quantity.name), "", script(drawing), Topic::fit};
  out.caption = fmt::format(
      "Autocorrelation of the residuals of {}{}{}. For white residuals 99 % of the values lie inside the band; a pattern shows "
      "{} that the model lacks.",
      quantity.name, where, crossed.shown.empty() ? "" : ", and below it their correlation with past values of the input",
      prediction.rows ? "a dependence" : "dynamics");
  if (quantity.response.draws != 1)
    out.caption +=
        " Residuals are measured minus mean prediction of the draws; the checks of a fit use those of its best mode, divided by "
        "the "
        "sd of the noise.";
  if (!crossed.shown.empty())
    out.caption += " Bars outside the band of a lower panel show effects of the input that the model misses.";
  if (crossed.hidden > 0)
    out.caption += fmt::format(" Shown are the first {} of {} inputs.", most_crossed, most_crossed + crossed.hidden);
  if (crossed.constant > 0) out.caption += " A constant input has no correlation.";
  return out;
}

}  // namespace sysid
