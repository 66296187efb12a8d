// Figures of the draws, small multiples: traces and ranks.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/numeric/not_finite.hpp"
#include "core/numeric/order.hpp"
#include "report/figure/drawing.hpp"
#include "report/figure/figures.hpp"
#include "report/figure/small_multiples.hpp"

namespace sysid {

using namespace plot;

namespace {

/// Of each chain, as long as so many keys can be told apart.
std::vector<Key> chain_keys(Draws const& draws) {
  std::vector<Key> keys;
  std::size_t const count = draws.chains.size();
  if (count < 2 || count > 2 * std::size(chains)) return keys;
  for (std::size_t c = 0; c < count; ++c)
    keys.push_back(
        {c < std::size(chains) ? Key::line : Key::dashes, chains[c % std::size(chains)], fmt::format("chain {}", c + 1)});
  return keys;
}

/// Small multiples of parameters under the legend of the chains.
struct ChainMultiples {
  Legend legend;
  SmallMultiples multiples;

  ChainMultiples(std::vector<Key> keys, std::size_t count, int per_row, int height, int below)
      : legend{std::move(keys), 14, 9}, multiples(count, per_row, height, below, legend.keys.empty() ? 0 : 8 + legend.height()) {}
  Drawing drawing(std::string name) const { return {std::move(name), multiples.width, multiples.height, legend}; }
};

// --- traces

Axis draw_axis(std::size_t longest) {
  Axis x = axis(0, static_cast<double>(longest), 3);
  std::erase_if(x.ticks, [](auto const& tick) { return tick.first != std::floor(tick.first); });
  x.exponent = 0;
  return x;
}

/// One draw in `stride` of each chain.
void add_traces(Plot& plot, Draws const& draws, std::size_t parameter, std::size_t stride) {
  for (std::size_t c = 0; c < draws.chains.size(); ++c) {
    Table table{fmt::format("chain{}_{}", parameter, c), {}};
    auto const& values = draws.chains[c].values;
    for (std::size_t d = 0; d < values.size(); d += stride)
      table.rows.push_back({plot.panel.x.scaled(static_cast<double>(d + 1)), plot.panel.y.scaled(values[d][parameter])});
    plot.series.push_back(indexed_line(table.name, 0.6, c));
    plot.tables.push_back(std::move(table));
  }
}

// --- ranks

constexpr int rank_bins = 20;

/// The bin of the rank of each draw, chain after chain. Of equal values all chains get their share of the ranks, the first draws of
/// each before the second.
std::vector<int> rank_bin_of_draws(Draws const& draws, std::size_t parameter) {
  std::vector<Ranked> order;  // the first draws of all chains, their second ones, ...: equal values stay in this order
  std::size_t longest = 0;
  for (auto const& chain : draws.chains) longest = std::max(longest, chain.values.size());
  for (std::size_t d = 0; d < longest; ++d) {
    std::size_t before = 0;
    for (auto const& chain : draws.chains) {
      if (d < chain.values.size()) {
        double const value = chain.values[d][parameter];
        order.push_back({std::isnan(value) ? infinity : value + 0.0, static_cast<std::uint32_t>(before + d)});  // no -0
      }
      before += chain.values.size();
    }
  }
  sort_by_value(order);
  std::vector<int> bins(order.size());
  for (std::size_t r = 0; r < order.size(); ++r) bins[order[r].place] = static_cast<int>(r * rank_bins / order.size());
  return bins;
}

/// How many ranks of one chain a bin holds: mean and half width of the 95 % band. Of independent draws the ranks of one chain in a
/// bin are hypergeometric; chains are correlated, so the band is a guide.
struct ExpectedRanks {
  double mean, spread;

  explicit ExpectedRanks(Draws const& draws) {
    auto const total = static_cast<double>(draws.total()), chain_count = static_cast<double>(draws.chains.size());
    mean = total / chain_count / rank_bins;
    double const others = (total - total / chain_count) / std::max(1.0, total - 1);
    spread = 1.96 * std::sqrt(mean * (1 - 1.0 / rank_bins) * others);
  }
};

Plot rank_plot(Draws const& draws, std::size_t parameter, Panel panel) {
  ExpectedRanks const expected(draws);
  std::string const guide = fmt::format("guide{}", parameter);
  Plot out{std::move(panel), {}, {band(guide, 2, 3, noise_band)}};
  double largest = expected.mean + 1.5 * expected.spread;
  std::vector<int> const bin_of = rank_bin_of_draws(draws, parameter);
  std::size_t draw = 0;
  for (std::size_t c = 0; c < draws.chains.size(); ++c) {
    std::vector<double> counts(rank_bins, 0);
    for (std::size_t d = 0; d < draws.chains[c].values.size(); ++d) ++counts[static_cast<std::size_t>(bin_of[draw++])];
    largest = std::max(largest, *std::max_element(counts.begin(), counts.end()));
    Table table{fmt::format("rank{}_{}", parameter, c), {}};
    for (int b = 0; b < rank_bins; ++b)
      for (int const edge : {b, b + 1})
        table.rows.push_back({static_cast<double>(edge) / rank_bins, counts[static_cast<std::size_t>(b)]});
    out.series.push_back(indexed_line(table.name, 1.1, c));
    out.tables.push_back(std::move(table));
  }
  double const low = std::max(0.0, expected.mean - expected.spread), high = expected.mean + expected.spread;
  out.tables.push_back({guide, {{0, low, high}, {1, low, high}}});
  out.panel.x = axis(0, 1, 2);
  out.panel.y = axis(0, 1.05 * largest, 3);
  out.panel.y.exponent = 0;
  out.panel.x_label = fmt::format("rank of {}", draws.names[parameter]);
  out.panel.y_label = "draws";
  out.panel.y_label_distance = 0;  // as near as the numbers let it
  return out;
}

}  // namespace

Figure trace_figure(Draws const& draws) {
  std::size_t const count = std::min(draws.names.size(), shown_multiples);
  ChainMultiples const layout(chain_keys(draws), count, 2, 118, 16);
  Drawing drawing = layout.drawing("trace");
  std::size_t longest = 1;
  for (Chain const& chain : draws.chains) longest = std::max(longest, chain.values.size());
  std::size_t const stride = (longest + 399) / 400;
  for (std::size_t i = 0; i < count; ++i) {
    auto const [low, high] = finite_range(draws.column(i));
    Plot plot{layout.multiples.panel(i, {66, 20, 24, 8})};
    plot.panel.x = draw_axis(longest);
    plot.panel.y = axis(low, high, 3, 0.05);
    plot.panel.y_label = axis_label(draws.names[i], draws.units[i], plot.panel.y);
    if (layout.multiples.in_last_row(i)) plot.panel.x_label = "draw";
    add_traces(plot, draws, i, stride);
    drawing.plots.push_back(std::move(plot));
  }
  Figure out{"trace", "Traces", "", script(drawing), Topic::chains};
  out.caption =
      "Draws of each chain (one colour each) in order. Converged chains look alike, like noise around one level; a drift, steps or "
      "separate levels show that they have not converged.";
  if (stride > 1) out.caption += fmt::format(" One draw in {} is shown.", stride);
  out.caption += multiples_excluded(draws.names.size());
  return out;
}

Figure rank_figure(Draws const& draws) {
  std::size_t const count = std::min(draws.names.size(), shown_multiples);
  std::vector<Key> keys = chain_keys(draws);
  keys.push_back({Key::area, noise_band, "95 % of independent draws"});
  ChainMultiples const layout(std::move(keys), count, 3, 132, 0);
  Drawing drawing = layout.drawing("ranks");
  for (std::size_t i = 0; i < count; ++i) drawing.plots.push_back(rank_plot(draws, i, layout.multiples.panel(i, {48, 10, 44, 8})));
  Figure out{"ranks", "Rank plots", "", script(drawing), Topic::chains};
  out.caption =
      "Rank plot: all draws are sorted by value and divided into twenty equal groups; the plot shows how many draws of each chain "
      "fall into each group (ranks as fractions). Converged chains are level and inside the band, which is computed for "
      "independent draws. A slope shows a chain at another level than the rest; a "
      "hump shows a chain with another spread." +
      multiples_excluded(draws.names.size());
  return out;
}

}  // namespace sysid
