// Draws of each pair of parameters against each other.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "core/text/number.hpp"
#include "report/figure/axis.hpp"
#include "report/figure/drawing.hpp"
#include "report/figure/figures.hpp"

namespace sysid {

namespace {

using namespace plot;

constexpr std::size_t shown_pairs = 7;
constexpr std::size_t shown_draws = 600;

double correlation(std::vector<double> const& a, std::vector<double> const& b) {
  auto const n = static_cast<double>(a.size());
  double mean_a = 0, mean_b = 0, ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    mean_a += a[i] / n;
    mean_b += b[i] / n;
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - mean_a) * (b[i] - mean_b);
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
  }
  return ab / std::sqrt(aa * bb);
}

/// Which parameters are shown, in their order: where there are too many, those of the strongest correlations. Derived quantities
/// would hide these, each going with what it is derived from: they stand behind.
std::vector<std::size_t> shown_parameters(Draws const& draws, std::vector<std::vector<double>> const& thinned) {
  std::vector<std::size_t> out(std::min(draws.names.size(), shown_pairs));
  std::iota(out.begin(), out.end(), std::size_t{0});
  auto const sampled = static_cast<std::size_t>(draws.parameter_count);
  if (sampled <= shown_pairs) return out;
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t a = 0; a < sampled; ++a)
    for (std::size_t b = 0; b < a; ++b) {
      double const r = correlation(thinned[a], thinned[b]);
      pairs.emplace_back(std::isfinite(r) ? -std::fabs(r) : 0, b, a);
    }
  std::sort(pairs.begin(), pairs.end());
  out.clear();
  for (auto const& [strength, a, b] : pairs)
    for (std::size_t const each : {a, b})
      if (out.size() < shown_pairs && std::find(out.begin(), out.end(), each) == out.end()) out.push_back(each);
  std::sort(out.begin(), out.end());
  return out;
}

/// An axis of a panel so many pixels wide: the fewest ticks of which two have numbers that stay clear of the neighbouring panels',
/// counted from the digits they share where the numbers are too long for that.
Axis panel_axis(std::pair<double, double> extent, int pixels) {
  Axis best;
  std::size_t most = 0;
  for (auto* const make : {&axis, &counted_axis})
    for (int wanted = 3; wanted <= 6 && most < 2; ++wanted) {
      Axis next = make(extent.first, extent.second, wanted, 0.05);
      double widest = 0;
      for (auto const& [place, number] : next.ticks) widest = std::max(widest, text_pixels(number));
      next.clear_edges(std::max(0.12, (widest / 2 - 2) / pixels));
      Axis thinned = next;
      thinned.thin_numbers(pixels, false);
      if (!best.ticks.empty() && thinned.numbers() <= most) continue;
      most = thinned.numbers();
      best = std::move(next);
    }
  return best;
}

/// What is shown of each parameter: all its draws, and evenly thinned ones.
struct Pairs {
  std::vector<std::string> names, units;
  std::vector<std::vector<double>> all, thinned;
  std::vector<Axis> axes;

  std::size_t count() const { return names.size(); }
  std::string label(std::size_t parameter) const { return axis_label(names[parameter], units[parameter], axes[parameter]); }
};

Pairs pairs_of(Draws const& draws) {
  std::vector<std::vector<double>> thinned(draws.names.size());
  std::size_t const stride = (static_cast<std::size_t>(draws.total()) + shown_draws - 1) / shown_draws;
  for (std::size_t i = 0; i < thinned.size(); ++i) {
    std::vector<double> const column = draws.column(i);
    for (std::size_t d = 0; d < column.size(); d += stride) thinned[i].push_back(column[d]);
  }
  Pairs out;
  for (std::size_t const each : shown_parameters(draws, thinned)) {
    out.names.push_back(draws.names[each]);
    out.units.push_back(draws.units[each]);
    out.all.push_back(draws.column(each));
    out.thinned.push_back(std::move(thinned[each]));
  }
  return out;
}

/// Panels in a square. Three stand in one column of print, more need the page. Pixels.
struct Square {
  int count, left = 70, bottom = 48, edge = 6, gap = 8;
  int width = std::max(column_width, left + edge + 110 * count);
  int panel_width = (width - left - edge) / count, panel_height = std::min(panel_width, 110);
  int height = bottom + panel_height * count + edge;

  explicit Square(std::size_t panels) : count(static_cast<int>(panels)) {}
  Panel panel(std::size_t row, std::size_t column, Axis const& x) const {
    double const begin = left + static_cast<double>(column) * panel_width;
    double const end = height - 4.0 - static_cast<double>(row) * panel_height;
    return panel_at(begin, begin + panel_width - gap, end - panel_height + gap, end, x, {});
  }
};

/// Labels stand along the left and the lower edge of the square.
Panel labelled(Panel panel, Pairs const& of, Square const& square, std::size_t row, std::size_t column) {
  bool const last = row + 1 == of.count();
  panel.x_numbers = last;
  panel.x_label_room = square.panel_width - square.edge;
  panel.y_label_room = square.panel_height - square.edge;
  if (last) panel.x_label = of.label(column);
  return panel;
}

Plot correlation_plot(Pairs const& of, std::size_t row, std::size_t column, Panel panel) {
  double const r = correlation(of.all[row], of.all[column]);
  return {std::move(panel),
          {},
          {},
          Note{std::isfinite(r) ? fmt::format("{}{:.2f}", r <= -0.005 ? "−" : "", std::fabs(r)) : "-",
               std::fabs(r) >= 0.5 ? contrast : muted}};
}

Plot histogram_plot(Pairs const& of, std::size_t parameter, Panel panel) {
  constexpr std::size_t bins = 24;
  std::vector<double> counts(bins, 0);
  Axis const& x = of.axes[parameter];
  double const extent = x.high - x.low;
  for (double const v : of.all[parameter]) {
    if (!std::isfinite(v)) continue;
    ++counts[std::min(bins - 1, static_cast<std::size_t>((x.scaled(v) - x.low) / extent * static_cast<double>(bins)))];
  }
  Table outline{fmt::format("h{}", parameter), {}};
  for (std::size_t b = 0; b < bins; ++b)
    for (std::size_t edge : {b, b + 1}) outline.rows.push_back({x.low + extent * static_cast<double>(edge) / bins, counts[b]});
  panel.y = {0, 1.08 * std::max(1.0, *std::max_element(counts.begin(), counts.end())), 0, {}};
  panel.y_axis = false;
  std::vector<Series> series{area(outline.name, response_band), line(outline.name, 2, 1, model)};
  return {std::move(panel), {std::move(outline)}, std::move(series)};
}

Plot cloud_plot(Pairs const& of, std::size_t row, std::size_t column, Panel panel) {
  panel.y = of.axes[row];
  panel.y_numbers = column == 0;
  panel.y_label_distance = 54;
  if (column == 0) panel.y_label = of.label(row);
  Table cloud{fmt::format("p{}_{}", row, column), {}};
  for (std::size_t d = 0; d < of.thinned[row].size(); ++d)
    cloud.rows.push_back({of.axes[column].scaled(of.thinned[column][d]), of.axes[row].scaled(of.thinned[row][d])});
  std::vector<Series> series{points(cloud.name, 2, 0.18, model)};
  return {std::move(panel), {std::move(cloud)}, std::move(series)};
}

std::string caption_of(Draws const& draws, std::size_t count) {
  std::string out =
      "Draws of each pair of parameters, with their correlation above the diagonal. In a narrow slanted cloud the data "
      "determine a combination of the two parameters, but not each of them; separate clouds are separate modes.";
  if (std::size_t const hidden = draws.names.size() - count; hidden > 0)
    out += fmt::format(" Shown are {} of {}, {}; {} {} left out.", count, draws.names.size(),
                       static_cast<std::size_t>(draws.parameter_count) > count
                           ? "those with the strongest correlations among the parameters"
                           : "the first",
                       hidden, hidden == 1 ? "is" : "are");
  return out;
}

}  // namespace

Figure pair_figure(Draws const& draws) {
  Pairs of = pairs_of(draws);
  Square const square(of.count());
  for (std::vector<double> const& values : of.all)
    of.axes.push_back(panel_axis(finite_range(values), square.panel_width - square.gap));
  Drawing drawing{"pairs", square.width, square.height};
  drawing.grid = false;
  for (std::size_t row = 0; row < of.count(); ++row)
    for (std::size_t column = 0; column < of.count(); ++column) {
      Panel const bare = square.panel(row, column, of.axes[column]);
      if (column > row) {
        drawing.plots.push_back(correlation_plot(of, row, column, bare));
        continue;
      }
      Panel panel = labelled(bare, of, square, row, column);
      drawing.plots.push_back(row == column ? histogram_plot(of, row, std::move(panel))
                                            : cloud_plot(of, row, column, std::move(panel)));
    }
  return {"pairs", "Pairs", caption_of(draws, of.count()), script(drawing)};
}

}  // namespace sysid
