// Figures of the draws, one cell per parameter: marginals, traces, ranks.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "report/figures.hpp"
#include "report/number.hpp"

namespace sysid {

namespace {

using namespace plot;

/// A page holds no more cells.
constexpr std::size_t shown_parameters = 18;

std::vector<double> pooled(Draws const& draws, std::size_t parameter) {
  std::vector<double> out;
  for (Chain const& chain : draws.chains)
    for (auto const& row : chain.values) out.push_back(row[parameter]);
  return out;
}

std::string left_out(Draws const& draws) {
  return draws.names.size() > shown_parameters ? fmt::format(" Shown are the first {} of {}.", shown_parameters, draws.names.size())
                                               : "";
}

/// All draws, but for tails so long that the bulk would be one bar: then the central 98 %.
std::pair<double, double> shown_range(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  double const low = quantile(values, 0.01), high = quantile(values, 0.99);
  bool const long_tails = values.back() - values.front() > 8 * (high - low) && high > low;
  return long_tails ? std::pair{low, high} : range(values);
}

/// Cells in rows of `columns`, each with room for its labels.
struct Grid {
  int columns, rows, cell_width, cell_height, width, height;
  /// `below`: pixels under the last row.
  Grid(std::size_t cells, int per_row, int w, int h, int below = 0)
      : columns(std::min(per_row, static_cast<int>(cells))),
        rows((static_cast<int>(cells) + columns - 1) / columns),
        cell_width(w / columns),
        cell_height(h),
        width(w),
        height(rows * h + below) {}
  Panel cell(std::size_t index, double left, double right, double bottom, double top) const {
    int const column = static_cast<int>(index) % columns, row = static_cast<int>(index) / columns;
    double const x = column * cell_width, y = height - (row + 1) * cell_height;
    return panel_at(x + left, x + cell_width - right, y + bottom, y + cell_height - top, {}, {});
  }
};

struct Histogram {
  double low, width;
  std::vector<double> density;

  /// Of the draws in [from, to]; the density is that of all draws.
  Histogram(std::vector<double> values, double from, double to) {
    std::sort(values.begin(), values.end());
    double const n = static_cast<double>(values.size());
    low = from;
    double const extent = to - low;
    double const quartiles = quantile(values, 0.75) - quantile(values, 0.25);
    // Freedman and Diaconis 1981, kept within what the eye can read.
    double const rule = quartiles > 0 ? extent / (2 * quartiles / std::cbrt(n)) : 1;
    auto const bins = static_cast<std::size_t>(std::clamp(std::ceil(rule), 12.0, 48.0));
    width = extent > 0 ? extent / static_cast<double>(bins) : 1;
    density.assign(bins, 0);
    for (double const v : values)
      if (v >= from && v <= to) density[std::min(bins - 1, static_cast<std::size_t>((v - low) / width))] += 1 / (n * width);
  }

  /// The outline between two abscissae, as corners.
  std::vector<std::vector<double>> outline(Axis const& x, double from, double to) const {
    std::vector<std::vector<double>> out;
    for (std::size_t b = 0; b < density.size(); ++b) {
      double const begin = std::max(low + static_cast<double>(b) * width, from);
      double const end = std::min(low + static_cast<double>(b + 1) * width, to);
      if (begin >= end) continue;
      out.push_back({x.scaled(begin), density[b]});
      out.push_back({x.scaled(end), density[b]});
    }
    return out;
  }
};

}  // namespace

Figure posterior_figure(Report const& report) {
  std::size_t const count = std::min(report.summary.size(), shown_parameters);
  Grid const grid(count, 3, 760, 176);
  Figure out{"posterior", "Posterior and prior", "", preamble("posterior", grid.width, grid.height)};
  bool any_prior = false;
  std::string cut_names;
  for (std::size_t i = 0; i < count; ++i) {
    Summary const& summary = report.summary[i];
    std::vector<double> const values = pooled(report.draws, i);
    auto const [low, high] = shown_range(values);
    Histogram const histogram(values, low, high);
    if (std::pair{low, high} != range(values)) cut_names += (cut_names.empty() ? "" : ", ") + summary.name;
    Panel p = grid.cell(i, 14, 14, 44, 26);
    p.x = axis(low, high, 4, 0.06);
    p.x.clear_edges(0.03);
    double const peak = *std::max_element(histogram.density.begin(), histogram.density.end());
    p.y = {0, 1.06 * peak, 0, {}};
    p.y_axis = false;
    p.x_label = axis_label(summary.name, summary.unit, p.x.exponent);
    Summary on_axis = summary;
    on_axis.mean = p.x.scaled(summary.mean);
    on_axis.sd = p.x.scaled(summary.sd);
    p.title = mean_and_sd(on_axis);
    double const infinity = std::numeric_limits<double>::infinity();
    out.script += data_block(fmt::format("all{}", i), histogram.outline(p.x, -infinity, infinity));
    out.script += data_block(fmt::format("inner{}", i), histogram.outline(p.x, summary.q5, summary.q95));
    out.script += panel(p, grid.width, grid.height);
    out.script += fmt::format(
        "plot $all{0} using 1:2 with filledcurves y1=0 fc rgb '{1}' fs noborder, $inner{0} using 1:2 with filledcurves y1=0 fc rgb "
        "'{2}' fs noborder, "
        "$all{0} using 1:2 with lines lw 1.2 lc rgb '{3}'",
        i, noise_band, response_band, model);
    auto const prior =
        std::find_if(report.priors.begin(), report.priors.end(), [&](PriorInfo const& info) { return info.name == summary.name; });
    if (prior != report.priors.end() && prior->density) {
      any_prior = true;
      std::vector<std::vector<double>> curve;
      double const scale = std::pow(10.0, p.x.exponent);
      for (int k = 0; k <= 120; ++k) {
        double const at = p.x.low + (p.x.high - p.x.low) * k / 120;
        curve.push_back({at, prior->density(at * scale)});
      }
      out.script += fmt::format(", $prior{} using 1:2 with lines lw 1.4 dt (6,4) lc rgb '{}'", i, contrast);
      std::size_t const at = out.script.rfind(fmt::format("$all{} <<", i));
      out.script.insert(at, data_block(fmt::format("prior{}", i), curve));
    }
    out.script += '\n';
  }
  out.script += "unset multiplot\n";
  out.caption = fmt::format(
      "Marginal posteriors; the darker part holds 90 %, the numbers above are mean ± sd, in the unit of the axis.{}{}{}",
      any_prior ? " Dashed: the prior density. A posterior that follows it has learnt nothing from the data; "
                  "one that stands against an edge is cut "
                  "by the prior."
                : "",
      cut_names.empty() ? "" : fmt::format(" Of {} the central 98 % are shown: the tails reach much farther.", cut_names),
      left_out(report.draws));
  return out;
}

Figure trace_figure(Draws const& draws) {
  std::size_t const count = std::min(draws.names.size(), shown_parameters);
  Grid const grid(count, 2, 760, 122, 16);
  Figure out{"trace", "Traces", "", preamble("trace", grid.width, grid.height)};
  std::size_t longest = 1;
  for (Chain const& chain : draws.chains) longest = std::max(longest, chain.values.size());
  std::size_t const stride = (longest + 399) / 400;
  for (std::size_t i = 0; i < count; ++i) {
    auto const [low, high] = range(pooled(draws, i));
    Panel p = grid.cell(i, 68, 16, 24, 6);
    p.x = axis(0, static_cast<double>(longest), 4);
    p.x.exponent = 0;
    p.y = axis(low, high, 3, 0.05);
    p.y_label = axis_label(draws.names[i], draws.units[i], p.y.exponent);
    if (i / static_cast<std::size_t>(grid.columns) + 1 == static_cast<std::size_t>(grid.rows)) p.x_label = "draw";
    std::string plots;
    for (std::size_t c = 0; c < draws.chains.size(); ++c) {
      std::vector<std::vector<double>> rows;
      for (std::size_t d = 0; d < draws.chains[c].values.size(); d += stride)
        rows.push_back({p.x.scaled(static_cast<double>(d + 1)), p.y.scaled(draws.chains[c].values[d][i])});
      out.script += data_block(fmt::format("chain{}_{}", i, c), rows);
      plots += fmt::format("{}$chain{}_{} using 1:2 with lines lw 0.7 lc rgb '{}'", c == 0 ? "plot " : ", ", i, c,
                           chains[c % std::size(chains)]);
    }
    out.script += panel(p, grid.width, grid.height) + plots + "\n";
  }
  out.script += "unset multiplot\n";
  out.caption =
      "Draws of each chain (one colour each) in order. Chains that agree look alike, like noise around one level; a drift, steps "
      "or "
      "separate levels say that they have not converged.";
  if (stride > 1) out.caption += fmt::format(" One draw in {} is shown.", stride);
  out.caption += left_out(draws);
  return out;
}

Figure rank_figure(Draws const& draws) {
  constexpr int bins = 20;
  std::size_t const count = std::min(draws.names.size(), shown_parameters);
  Grid const grid(count, 3, 760, 150);
  Figure out{"ranks", "Rank plots", "", preamble("ranks", grid.width, grid.height)};
  auto const total = static_cast<double>(draws.total());
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<double> const values = pooled(draws, i);
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
    std::vector<int> bin_of(values.size());
    for (std::size_t r = 0; r < order.size(); ++r) bin_of[order[r]] = static_cast<int>(r * bins / order.size());
    double const expected = total / static_cast<double>(draws.chains.size()) / bins;
    // Counts of independent draws are binomial; chains are correlated, so the band is a guide, not a test.
    double const spread = 1.96 * std::sqrt(expected * (1 - 1.0 / bins));
    double largest = expected + 1.5 * spread;
    std::string plots;
    std::size_t draw = 0;
    for (std::size_t c = 0; c < draws.chains.size(); ++c) {
      std::vector<double> counts(bins, 0);
      for (std::size_t d = 0; d < draws.chains[c].values.size(); ++d) ++counts[static_cast<std::size_t>(bin_of[draw++])];
      std::vector<std::vector<double>> rows;
      for (int b = 0; b < bins; ++b) {
        rows.push_back({static_cast<double>(b) / bins, counts[static_cast<std::size_t>(b)]});
        rows.push_back({static_cast<double>(b + 1) / bins, counts[static_cast<std::size_t>(b)]});
      }
      largest = std::max(largest, *std::max_element(counts.begin(), counts.end()));
      out.script += data_block(fmt::format("rank{}_{}", i, c), rows);
      plots += fmt::format(", $rank{}_{} using 1:2 with lines lw 1.2 lc rgb '{}'", i, c, chains[c % std::size(chains)]);
    }
    out.script += data_block(fmt::format("guide{}", i), {{0, std::max(0.0, expected - spread), expected + spread},
                                                         {1, std::max(0.0, expected - spread), expected + spread}});
    Panel p = grid.cell(i, 40, 12, 44, 8);
    p.x = axis(0, 1, 2);
    p.y = axis(0, 1.05 * largest, 3);
    p.y.exponent = 0;
    p.x_label = fmt::format("rank of {}", draws.names[i]);
    out.script += panel(p, grid.width, grid.height);
    out.script += fmt::format("plot $guide{} using 1:2:3 with filledcurves fc rgb '{}' fs noborder{}\n", i, noise_band, plots);
  }
  out.script += "unset multiplot\n";
  out.caption =
      "How often each chain's draws fall into each twentieth of all draws (ranks as shares of the whole). Converged chains are "
      "level and "
      "inside the band, which holds for independent draws; a slope or a hump is a chain that sits elsewhere or spreads "
      "otherwise "
      "than the rest." +
      left_out(draws);
  return out;
}

}  // namespace sysid
