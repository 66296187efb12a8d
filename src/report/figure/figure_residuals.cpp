// What is left in the residuals of a channel: their autocorrelation, and their correlation with each input before them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnostics/residual_tests.hpp"
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

std::string correlation_panel(Correlations const& shown, std::string const& label, Panel p, int lags, int width, int height,
                              std::string_view colour) {
  std::vector<double> all = shown.test.correlation;
  std::vector<std::vector<double>> bars, limits;
  for (std::size_t i = 0; i < shown.test.correlation.size(); ++i) {
    double const lag = shown.test.first_lag + static_cast<double>(i);
    bars.push_back({lag, shown.test.correlation[i]});
    limits.push_back({lag, -shown.test.bound[i], shown.test.bound[i]});
    for (double const factor : {-1.5, 1.5}) all.push_back(factor * shown.test.bound[i]);
  }
  // The band ends with the panel, not with the last lag.
  limits.insert(limits.begin(), {-0.5, limits.front()[1], limits.front()[2]});
  limits.push_back({lags + 1.0, limits.back()[1], limits.back()[2]});
  auto const [low, high] = finite_range(all);
  p.x = axis(-0.5, lags + 1, 7);
  p.x.exponent = 0;
  p.y = axis(std::min(low, 0.0), std::max(high, 0.0), 3, 0.05);
  p.y_label = axis_label(label, "", p.y);
  for (auto& row : bars) row[1] = p.y.scaled(row[1]);
  for (auto& row : limits)
    for (std::size_t c : {1U, 2U}) row[c] = p.y.scaled(row[c]);
  return data_block(shown.name, bars) + data_block(shown.name + "_limit", limits) + panel(p, width, height) +
         fmt::format(
             "plot ${0}_limit using 1:2:3 with filledcurves fc rgb '{1}' fs noborder, 0 with lines lw 1 lc rgb '{2}', "
             "${0} using 1:2 with impulses lw 2.4 lc rgb '{3}'\n",
             shown.name, noise_band, muted, colour);
}

}  // namespace

bool has_residuals(Prediction const& prediction, PredictedQuantity const& quantity) {
  std::vector<double> const residuals = residuals_of(prediction, quantity);
  return number_of(residuals) >= least_residuals && !whiteness(residuals, 1).correlation.empty();
}

Figure residual_figure(Prediction const& prediction, PredictedQuantity const& quantity) {
  std::vector<double> const residuals = residuals_of(prediction, quantity);
  Correlations const own{whiteness(residuals, most_lags), "", "acf"};
  int const lags = static_cast<int>(own.test.correlation.size());

  // Rows of any order have no input before them.
  std::vector<Correlations> crossed;
  std::size_t constant = 0;
  for (std::size_t k = 0; k < prediction.inputs.size() && !prediction.rows; ++k) {
    PredictedInput const& input = prediction.inputs[k];
    Correlations each{input_correlation(residuals, input.values, lags), input.name, fmt::format("input{}", k)};
    std::vector<double> const& found = each.test.correlation;
    if (!found.empty() && std::all_of(found.begin(), found.end(), [](double one) { return std::isfinite(one); }))
      crossed.push_back(std::move(each));
    else
      ++constant;
  }
  std::size_t const left_out = crossed.size() > most_crossed ? crossed.size() - most_crossed : 0;
  crossed.resize(crossed.size() - left_out);

  int const width = column_width, each = 118, below = 44, height = below + each * (1 + static_cast<int>(crossed.size()));
  Figure out;
  out.topic = Topic::fit;
  out.name = identifier(fmt::format("residuals_{}_{}", prediction.experiment, quantity.name));
  out.title = fmt::format("Correlations of the residuals of {}", quantity.name);
  out.script = preamble(out.name, width, height);
  int top = height - 10;
  auto const place = [&](bool last) {
    Panel p = panel_at(70, width - 14.0, top - each + 22.0, top, {}, {});
    top -= each;
    p.x_numbers = last;
    if (last) p.x_label = prediction.rows ? "lag [rows]" : "lag [samples]";
    return p;
  };
  out.script += correlation_panel(own, "autocorrelation", place(crossed.empty()), lags, width, height, model);
  for (std::size_t k = 0; k < crossed.size(); ++k)
    out.script +=
        correlation_panel(crossed[k], "with " + crossed[k].label, place(k + 1 == crossed.size()), lags, width, height, contrast);
  out.script += "unset multiplot\n";
  out.caption = fmt::format(
      "Autocorrelation of the residuals of {}{}. For white residuals 99 % of the values lie inside the band; a pattern shows "
      "dynamics that the model lacks.",
      quantity.name, crossed.empty() ? "" : ", and below it their correlation with the input the same number of samples before");
  if (quantity.response.draws != 1)
    out.caption +=
        " Residuals are relative to the mean of the draws; the checks of a fit use those of its best mode, divided by the sd of "
        "the noise.";
  if (!crossed.empty()) out.caption += " Bars outside the lower band show effects of the input that the model misses.";
  if (left_out > 0) out.caption += fmt::format(" Shown are the first {} of {} inputs.", most_crossed, most_crossed + left_out);
  if (constant > 0) out.caption += " A constant input has no correlation.";
  return out;
}

}  // namespace sysid
