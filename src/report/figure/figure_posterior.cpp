// Marginal posteriors, one cell per parameter: draws, their density, the prior, and the truth of made data.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numeric/not_finite.hpp"
#include "core/text/number.hpp"
#include "report/figure/figures.hpp"
#include "report/figure/marginal.hpp"
#include "report/figure/small_multiples.hpp"
#include "report/text/summary_text.hpp"

namespace sysid {

namespace {

using namespace plot;

/// The finite ones, sorted.
std::vector<double> finite_draws(Draws const& draws, std::size_t parameter) {
  std::vector<double> out = draws.column(parameter);
  std::erase_if(out, [](double each) { return !std::isfinite(each); });
  std::sort(out.begin(), out.end());
  return out;
}

/// What the heads of all records say of a parameter; nothing when they say different things.
std::optional<double> truth_of(std::vector<DataInfo> const& data, std::string const& name) {
  std::optional<double> out;
  for (DataInfo const& each : data)
    for (TrueValue const& stated : each.truth) {
      if (stated.name != name) continue;
      if (out && *out != stated.value) return std::nullopt;
      out = stated.value;
    }
  return out;
}

std::vector<std::vector<double>> corners(std::vector<std::pair<double, double>> const& outline, Axis const& x, double peak) {
  std::vector<std::vector<double>> out;
  for (auto const& [at, density] : outline) out.push_back({x.scaled(at), density / peak});
  return out;
}

}  // namespace

Figure posterior_figure(Report const& report) {
  // Coefficients of unknown functions have a figure of their function.
  std::vector<std::size_t> columns;
  for (std::size_t c = 0; c < report.summary.size(); ++c)
    if (!report.summary[c].coefficient) columns.push_back(c);
  std::size_t const count = std::min(columns.size(), shown_cells);
  bool any_prior = false, any_truth = false, any_density = false;
  std::string cut_names, far_names, plots;
  int const above = 20;
  Cells const cells(count, 3, 150, 0, above);
  auto const add_name = [](std::string& list, std::string const& name) { list += (list.empty() ? "" : ", ") + name; };
  for (std::size_t i = 0; i < count; ++i) {
    Summary const& summary = report.summary[columns[i]];
    std::vector<double> const values = finite_draws(report.draws, columns[i]);
    if (values.empty()) {
      Panel p = cells.cell(i, 14, 12, 46, 20);
      p.x = p.y = axis(0, 1, 1);
      p.x.ticks.clear();
      p.y_axis = false;
      p.x_label = axis_label(summary.name, summary.unit);
      p.title = "no finite draw";
      plots += panel(p, cells.width, cells.height) + "plot NaN\n";
      if (i == 0) plots += end_legend();
      continue;
    }
    auto [low, high] = shown_range(values);
    if (low == high) {  // a bar that can be seen
      double const half = low == 0 ? 0.02 : 0.001 * std::fabs(low);
      low -= half;
      high += half;
    }
    Histogram const histogram(values, low, high);
    if (values.front() < low || values.back() > high) add_name(cut_names, summary.name);
    std::optional<double> const truth = truth_of(report.data, summary.name);
    bool const near = truth && *truth > low - (high - low) && *truth < high + (high - low);
    std::pair<double, double> const extent = near ? cover(std::pair(low, high), std::pair(*truth, *truth)) : std::pair{low, high};
    Panel p = cells.cell(i, 14, 12, 46, 20);
    p.x = axis(extent.first, extent.second, 4, 0.06);
    p.x.clear_edges(0.03);
    // Densities are drawn as parts of the highest bar: the figure has no axis for them, and 10^12 none for gnuplot.
    double const peak = histogram.peak();
    p.y = {0, 1.08, 0, {}};
    p.y_axis = false;
    p.x_label = axis_label(summary.name, summary.unit, p.x);
    Summary on_axis = summary;
    on_axis.mean = p.x.scaled(summary.mean);
    on_axis.sd = p.x.scaled_width(summary.sd);
    p.title = mean_and_sd(on_axis);
    auto const prior =
        std::find_if(report.priors.begin(), report.priors.end(), [&](PriorInfo const& info) { return info.name == summary.name; });
    bool const has_prior = prior != report.priors.end() && prior->density;
    any_prior = any_prior || has_prior;

    std::string blocks = data_block(fmt::format("all{}", i), corners(histogram.outline(-infinity, infinity), p.x, peak));
    blocks += data_block(fmt::format("inner{}", i), corners(histogram.outline(summary.q5, summary.q95), p.x, peak));
    std::string curves = fmt::format(
        "plot $all{0} using 1:2 with filledcurves y1=0 fc rgb '{1}' fs noborder, "
        "$inner{0} using 1:2 with filledcurves y1=0 fc rgb '{2}' fs noborder",
        i, noise_band, response_band);
    auto const add_curve = [&](char const* what, std::vector<std::vector<double>> const& rows, std::string const& style) {
      blocks += data_block(fmt::format("{}{}", what, i), rows);
      curves += fmt::format(", ${}{} using 1:2 with lines {}", what, i, style);
    };
    constexpr int points = 121;
    auto const place = [&](int k) { return p.x.low + (p.x.high - p.x.low) * k / (points - 1); };
    if (has_prior) {
      std::vector<std::vector<double>> rows;
      for (int k = 0; k < points; ++k) rows.push_back({place(k), prior->density(p.x.unscaled(place(k))) / peak});
      add_curve("prior", rows, fmt::format("lw 1.4 dt (6,4) lc rgb '{}'", contrast));
    }
    double const worth = std::isfinite(summary.ess_bulk) ? std::min(summary.ess_bulk, static_cast<double>(values.size()))
                                                         : static_cast<double>(values.size());
    double const reach = 5 * kernel_width(values, worth);
    double const smallest = values.front(), largest = values.back();
    double const lower = has_prior ? support_end(prior->density, smallest, smallest - reach) : -infinity;
    double const upper = has_prior ? support_end(prior->density, largest, largest + reach) : infinity;
    std::vector<double> const density =
        kernel_density(values, worth, p.x.unscaled(p.x.low), p.x.unscaled(p.x.high), points,
                       lower > smallest - reach ? lower : -infinity, upper < largest + reach ? upper : infinity);
    if (!density.empty()) {
      any_density = true;
      std::vector<std::vector<double>> rows;
      for (int k = 0; k < points; ++k) rows.push_back({place(k), density[static_cast<std::size_t>(k)] / peak});
      p.y.high = std::max(p.y.high, 1.08 * *std::max_element(density.begin(), density.end()) / peak);
      add_curve("density", rows, fmt::format("lw 1.6 lc rgb '{}'", model));
    }
    if (near) {
      any_truth = true;
      add_curve("truth", {{p.x.scaled(*truth), 0}, {p.x.scaled(*truth), p.y.high}}, fmt::format("lw 1.4 lc rgb '{}'", ink));
    } else if (truth) {
      add_name(far_names, fmt::format("{} ({})", summary.name, pretty_number(significant(*truth, 4))));
    }
    plots += blocks + panel(p, cells.width, cells.height) + curves + '\n';
    if (i == 0) plots += end_legend();
  }
  std::vector<Key> keys = {{Key::area, response_band, "90 % of the draws"}};
  if (any_density) keys.push_back({Key::line, model, "density"});
  if (any_prior) keys.push_back({Key::dashes, contrast, "prior"});
  if (any_truth) keys.push_back({Key::line, ink, "truth"});
  Figure out{"posterior", "Posterior and prior", "", preamble("posterior", cells.width, cells.height)};
  out.script += legend(keys, 10, cells.width - 12.0, cells.height - 9.0, cells.width, cells.height) + plots + "unset multiplot\n";
  out.caption =
      "Marginal posteriors, as a histogram of the draws and as a smooth density; the darker part holds 90 %, the numbers "
      "above are mean ± sd, in the unit of the axis.";
  if (any_prior)
    out.caption +=
        " Dashed: the prior density. Where the posterior equals the prior, the data contain no information; where it ends at an "
        "edge, it is truncated by the prior.";
  if (any_truth) out.caption += " The vertical line is the value with which the data were generated.";
  if (!far_names.empty()) out.caption += fmt::format(" Generated with values outside the shown range: {}.", far_names);
  if (!cut_names.empty())
    out.caption += fmt::format(" Of {} the central 98 % are shown: the tails extend much further.", cut_names);
  out.caption += cells_left_out(columns.size());
  return out;
}

}  // namespace sysid
