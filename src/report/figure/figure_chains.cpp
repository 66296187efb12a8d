// Figures of the draws, one cell per parameter: traces and ranks.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

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

/// Pixels from either side of the figure to its legend.
constexpr double legend_left = 10, legend_right = 14;

int room_for(std::vector<Key> const& keys) {
  return keys.empty() ? 0 : 8 + legend_height(keys, legend_left, column_width - legend_right);
}

std::string legend_of(std::vector<Key> const& keys, Cells const& cells) {
  return legend(keys, legend_left, cells.width - legend_right, cells.height - 9.0, cells.width, cells.height);
}

}  // namespace

Figure trace_figure(Draws const& draws) {
  std::size_t const count = std::min(draws.names.size(), shown_cells);
  std::vector<Key> const keys = chain_keys(draws);
  Cells const grid(count, 2, 118, 16, room_for(keys));
  Figure out{"trace", "Traces", "", preamble("trace", grid.width, grid.height) + legend_of(keys, grid), Topic::chains};
  std::size_t longest = 1;
  for (Chain const& chain : draws.chains) longest = std::max(longest, chain.values.size());
  std::size_t const stride = (longest + 399) / 400;
  for (std::size_t i = 0; i < count; ++i) {
    auto const [low, high] = finite_range(draws.column(i));
    Panel p = grid.cell(i, 66, 14, 24, 8);
    p.x = axis(0, static_cast<double>(longest), 3);
    std::erase_if(p.x.ticks, [](auto const& tick) { return tick.first != std::floor(tick.first); });
    p.x.exponent = 0;
    p.y = axis(low, high, 3, 0.05);
    p.y_label = axis_label(draws.names[i], draws.units[i], p.y);
    if (i / static_cast<std::size_t>(grid.columns) + 1 == static_cast<std::size_t>(grid.rows)) p.x_label = "draw";
    std::string plots;
    for (std::size_t c = 0; c < draws.chains.size(); ++c) {
      std::vector<std::vector<double>> rows;
      for (std::size_t d = 0; d < draws.chains[c].values.size(); d += stride)
        rows.push_back({p.x.scaled(static_cast<double>(d + 1)), p.y.scaled(draws.chains[c].values[d][i])});
      out.script += data_block(fmt::format("chain{}_{}", i, c), rows);
      plots += fmt::format("{}$chain{}_{} using 1:2 with lines lw 0.6 {}", c == 0 ? "plot " : ", ", i, c, series_colour(c));
    }
    out.script += panel(p, grid.width, grid.height) + plots + "\n";
    if (i == 0) out.script += end_legend();
  }
  out.script += "unset multiplot\n";
  out.caption =
      "Draws of each chain (one colour each) in order. Converged chains look alike, like noise around one level; a drift, steps or "
      "separate levels show that they have not converged.";
  if (stride > 1) out.caption += fmt::format(" One draw in {} is shown.", stride);
  out.caption += cells_left_out(draws.names.size());
  return out;
}

Figure rank_figure(Draws const& draws) {
  constexpr int bins = 20;
  std::size_t const count = std::min(draws.names.size(), shown_cells);
  std::vector<Key> keys = chain_keys(draws);
  keys.push_back({Key::area, noise_band, "95 % of independent draws"});
  Cells const grid(count, 3, 132, 0, room_for(keys));
  Figure out{"ranks", "Rank plots", "", preamble("ranks", grid.width, grid.height) + legend_of(keys, grid), Topic::chains};
  auto const total = static_cast<double>(draws.total());
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<double> const values = draws.column(i);
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    // Of equal values all chains get their share of the ranks, the first draws of each before the second.
    std::vector<std::size_t> place;
    for (auto const& chain : draws.chains)
      for (std::size_t d = 0; d < chain.values.size(); ++d) place.push_back(d);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      if (values[a] < values[b] || values[b] < values[a]) return values[a] < values[b];
      if (std::isnan(values[a]) != std::isnan(values[b])) return std::isnan(values[b]);
      return place[a] < place[b];
    });
    std::vector<int> bin_of(values.size());
    for (std::size_t r = 0; r < order.size(); ++r) bin_of[order[r]] = static_cast<int>(r * bins / order.size());
    double const expected = total / static_cast<double>(draws.chains.size()) / bins;
    // Of independent draws the ranks of one chain in a bin are hypergeometric; chains are correlated, so the band is a guide.
    double const others = (total - total / static_cast<double>(draws.chains.size())) / std::max(1.0, total - 1);
    double const spread = 1.96 * std::sqrt(expected * (1 - 1.0 / bins) * others);
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
      plots += fmt::format(", $rank{}_{} using 1:2 with lines lw 1.1 {}", i, c, series_colour(c));
    }
    out.script += data_block(fmt::format("guide{}", i), {{0, std::max(0.0, expected - spread), expected + spread},
                                                         {1, std::max(0.0, expected - spread), expected + spread}});
    Panel p = grid.cell(i, 48, 10, 44, 8);
    p.x = axis(0, 1, 2);
    p.y = axis(0, 1.05 * largest, 3);
    p.y.exponent = 0;
    p.x_label = fmt::format("rank of {}", draws.names[i]);
    p.y_label = "draws";
    p.y_label_distance = 0;  // as near as the numbers let it
    out.script += panel(p, grid.width, grid.height);
    out.script += fmt::format("plot $guide{} using 1:2:3 with filledcurves fc rgb '{}' fs noborder{}\n", i, noise_band, plots);
    if (i == 0) out.script += end_legend();
  }
  out.script += "unset multiplot\n";
  out.caption =
      "Rank plot: how often the draws of each chain fall into each twentieth of all draws (ranks as fractions). Converged chains "
      "are level and "
      "inside the band, which holds for independent draws; a slope or a hump shows a chain at another level or with another spread "
      "otherwise "
      "than the rest." +
      cells_left_out(draws.names.size());
  return out;
}

}  // namespace sysid
