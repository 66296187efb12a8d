// Marginal posteriors, small multiples: draws, their density, the prior, and the truth of made data.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "core/numeric/not_finite.hpp"
#include "core/numeric/order.hpp"
#include "core/text/number.hpp"
#include "report/figure/drawing.hpp"
#include "report/figure/figures.hpp"
#include "report/figure/marginal.hpp"
#include "report/figure/small_multiples.hpp"
#include "report/text/report_text.hpp"
#include "report/text/summary_text.hpp"

namespace sysid {

namespace {

using namespace plot;

/// The finite ones, sorted.
std::vector<double> finite_draws(Draws const& draws, std::size_t parameter) {
  std::vector<double> out = draws.column(parameter);
  std::erase_if(out, [](double each) { return !std::isfinite(each); });
  sort_numbers(out);
  return out;
}

/// What the heads of all records say of a parameter; nothing when they say different things.
std::optional<double> true_value_of(std::vector<DataInfo> const& data, std::string const& name) {
  std::optional<double> out;
  for (DataInfo const& each : data)
    for (TrueValue const& stated : each.true_parameters) {
      if (stated.name != name) continue;
      if (out && *out != stated.value) return std::nullopt;
      out = stated.value;
    }
  return out;
}

/// One parameter: its draws and what they are compared with.
struct Marginal {
  Summary const& summary;
  std::vector<double> draws;         // finite, sorted
  PriorInfo const* prior;            // null: has no density
  std::optional<double> true_value;  // of made data
  double low = 0, high = 1;          // of the draws that are shown
  bool true_value_is_near = false;   // to what is shown

  bool tails_cut() const { return draws.front() < low || draws.back() > high; }
};

Marginal marginal_of(Report const& report, std::size_t column) {
  Summary const& summary = report.summary[column];
  auto const prior =
      std::find_if(report.priors.begin(), report.priors.end(), [&](PriorInfo const& info) { return info.name == summary.name; });
  Marginal out{summary, finite_draws(report.draws, column), prior != report.priors.end() && prior->density ? &*prior : nullptr,
               true_value_of(report.data, summary.name)};
  if (out.draws.empty()) return out;
  std::tie(out.low, out.high) = shown_range(out.draws);
  if (out.low == out.high) {  // a bar that can be seen
    double const half = out.low == 0 ? 0.02 : 0.001 * std::fabs(out.low);
    out.low -= half;
    out.high += half;
  }
  double const extent = out.high - out.low;
  out.true_value_is_near = out.true_value && *out.true_value > out.low - extent && *out.true_value < out.high + extent;
  return out;
}

/// Where curves are computed.
constexpr int curve_points = 121;
double place(Axis const& x, int k) { return x.low + (x.high - x.low) * k / (curve_points - 1); }

// Densities are drawn as parts of the highest bar: the figure has no axis for them, and 10^12 none for gnuplot.

Rows histogram_rows(std::vector<std::pair<double, double>> const& outline, Axis const& x, double peak) {
  Rows out;
  for (auto const& [at, density] : outline) out.push_back({x.scaled(at), density / peak});
  return out;
}

Rows prior_rows(PriorInfo const& prior, Axis const& x, double peak) {
  Rows out;
  for (int k = 0; k < curve_points; ++k) out.push_back({place(x, k), prior.density(x.unscaled(place(x, k))) / peak});
  return out;
}

/// The density of the draws at the places of a curve; empty where they do not vary. It ends where the prior does.
std::vector<double> density_of(Marginal const& of, Axis const& x) {
  auto const number = static_cast<double>(of.draws.size());
  double const worth = std::isfinite(of.summary.ess_bulk) ? std::min(of.summary.ess_bulk, number) : number;
  double const reach = 5 * kernel_width(of.draws, worth);
  double const smallest = of.draws.front(), largest = of.draws.back();
  double const lower = of.prior != nullptr ? support_end(of.prior->density, smallest, smallest - reach) : -infinity;
  double const upper = of.prior != nullptr ? support_end(of.prior->density, largest, largest + reach) : infinity;
  return kernel_density(of.draws, worth, x.unscaled(x.low), x.unscaled(x.high), curve_points,
                        lower > smallest - reach ? lower : -infinity, upper < largest + reach ? upper : infinity);
}

constexpr Margins margins{14, 18, 46, 20};

Plot plot_without_draws(Summary const& summary, Panel panel) {
  panel.x = panel.y = axis(0, 1, 1);
  panel.x.ticks.clear();
  panel.y_axis = false;
  panel.x_label = axis_label(summary.name, summary.unit);
  panel.title = "no finite draw";
  return {std::move(panel)};
}

/// Axes, label and title of a panel; the ordinate holds the histogram.
Panel marginal_panel(Marginal const& of, Panel panel) {
  std::pair<double, double> extent(of.low, of.high);
  if (of.true_value_is_near) extent = cover(extent, {*of.true_value, *of.true_value});
  panel.x = axis(extent.first, extent.second, 4, 0.06);
  panel.x.clear_edges(0.03);
  panel.y = {0, 1.08, 0, {}};
  panel.y_axis = false;
  panel.x_label = axis_label(of.summary.name, of.summary.unit, panel.x);
  Summary on_axis = of.summary;
  on_axis.mean = panel.x.scaled(of.summary.mean);
  on_axis.sd = panel.x.scaled_width(of.summary.sd);
  panel.title = mean_and_sd(on_axis);
  return panel;
}

/// `kinds` collects which curves the figure has, for its legend and caption.
struct Kinds {
  bool density = false, prior = false, true_value = false;
};

Plot marginal_plot(Marginal const& of, std::size_t index, Panel const& at, Kinds& kinds) {
  Plot out{marginal_panel(of, at)};
  Axis const& x = out.panel.x;
  auto const add = [&](char const* what, Rows rows, auto const& series) {
    out.tables.push_back({fmt::format("{}{}", what, index), std::move(rows)});
    out.series.push_back(series(out.tables.back().name));
  };
  Histogram const histogram(of.draws, of.low, of.high);
  double const peak = histogram.peak();
  add("all", histogram_rows(histogram.outline(-infinity, infinity), x, peak),
      [](std::string const& table) { return area(table, noise_band); });
  add("inner", histogram_rows(histogram.outline(of.summary.q5, of.summary.q95), x, peak),
      [](std::string const& table) { return area(table, response_band); });
  if (of.prior != nullptr) {
    kinds.prior = true;
    add("prior", prior_rows(*of.prior, x, peak), [](std::string const& table) { return dashed_line(table, 1.4, contrast); });
  }
  if (std::vector<double> const density = density_of(of, x); !density.empty()) {
    kinds.density = true;
    Rows rows;
    for (int k = 0; k < curve_points; ++k) rows.push_back({place(x, k), density[static_cast<std::size_t>(k)] / peak});
    out.panel.y.high = std::max(out.panel.y.high, 1.08 * *std::max_element(density.begin(), density.end()) / peak);
    add("density", std::move(rows), [](std::string const& table) { return line(table, 2, 1.6, model); });
  }
  if (of.true_value_is_near) {
    kinds.true_value = true;
    add("truth", {{x.scaled(*of.true_value), 0}, {x.scaled(*of.true_value), out.panel.y.high}},
        [](std::string const& table) { return line(table, 2, 1.4, ink); });
  }
  return out;
}

std::vector<Key> keys_of(Kinds const& kinds) {
  std::vector<Key> keys = {{Key::area, response_band, "90 % of the draws"}};
  if (kinds.density) keys.push_back({Key::line, model, "density"});
  if (kinds.prior) keys.push_back({Key::dashes, contrast, "prior"});
  if (kinds.true_value) keys.push_back({Key::line, ink, "truth"});
  return keys;
}

/// far: parameters whose truth lies outside what is shown; cut: parameters whose tails are not shown.
std::string caption_of(Kinds const& kinds, std::string const& far, std::string const& cut, std::size_t parameters, bool particles) {
  std::string out = particles ? "Marginals of the particles" : "Marginal posteriors";
  out +=
      ", as a histogram of the draws and as a smooth density; the inner part contains 90\u00a0%, the numbers "
      "above are mean ± sd, in the unit of the axis.";
  if (kinds.prior)
    out += particles
               ? " Dashed: the prior density."
               : " Dashed: the prior density. Where the posterior equals the prior, the data contain no information; where it "
                 "ends at an edge, it is truncated by the prior.";
  if (kinds.true_value) out += " The vertical line is the value with which the data were generated.";
  if (!far.empty()) out += fmt::format(" Generated with values outside the shown range: {}.", far);
  if (!cut.empty()) out += fmt::format(" Of {} the central 98 % are shown: the tails extend much further.", cut);
  out += multiples_excluded(parameters);
  return out;
}

}  // namespace

Figure posterior_figure(Report const& report, bool particles) {
  // Coefficients of unknown functions have a figure of their function.
  std::vector<std::size_t> columns;
  for (std::size_t c = 0; c < report.summary.size(); ++c)
    if (!report.summary[c].coefficient) columns.push_back(c);
  std::size_t const count = std::min(columns.size(), shown_multiples);
  constexpr int above = 20;
  SmallMultiples const multiples(count, 3, 150, 0, above);
  Drawing drawing{"posterior", multiples.width, multiples.height};
  Kinds kinds;
  std::string cut, far;
  auto const add_name = [](std::string& list, std::string const& name) { list += (list.empty() ? "" : ", ") + name; };
  for (std::size_t i = 0; i < count; ++i) {
    Marginal const of = marginal_of(report, columns[i]);
    Panel const at = multiples.panel(i, margins);
    if (of.draws.empty()) {
      drawing.plots.push_back(plot_without_draws(of.summary, at));
      continue;
    }
    drawing.plots.push_back(marginal_plot(of, i, at, kinds));
    if (of.tails_cut()) add_name(cut, of.summary.name);
    if (of.true_value && !of.true_value_is_near)
      add_name(far, fmt::format("{} ({})", of.summary.name, quantity_text(*of.true_value, 4, of.summary.unit)));
  }
  drawing.legend = Legend{keys_of(kinds), 12, 9};
  return {"posterior", "Posterior and prior", caption_of(kinds, far, cut, columns.size(), particles), script(drawing)};
}

}  // namespace sysid
