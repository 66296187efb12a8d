// Figures of the draws, one cell per parameter: traces and ranks.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "report/cells.hpp"
#include "report/figures.hpp"

namespace sysid {

using namespace plot;

Figure trace_figure(Draws const& draws) {
  std::size_t const count = std::min(draws.names.size(), shown_cells);
  Cells const grid(count, 2, 118, 16);
  Figure out{"trace", "Traces", "", preamble("trace", grid.width, grid.height), Topic::chains};
  std::size_t longest = 1;
  for (Chain const& chain : draws.chains) longest = std::max(longest, chain.values.size());
  std::size_t const stride = (longest + 399) / 400;
  for (std::size_t i = 0; i < count; ++i) {
    auto const [low, high] = range(draws.column(i));
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
  }
  out.script += "unset multiplot\n";
  out.caption =
      "Draws of each chain (one colour each) in order. Chains that agree look alike, like noise around one level; a drift, steps "
      "or "
      "separate levels say that they have not converged.";
  if (stride > 1) out.caption += fmt::format(" One draw in {} is shown.", stride);
  out.caption += cells_left_out(draws.names.size());
  return out;
}

Figure rank_figure(Draws const& draws) {
  constexpr int bins = 20;
  std::size_t const count = std::min(draws.names.size(), shown_cells);
  Cells const grid(count, 3, 132);
  Figure out{"ranks", "Rank plots", "", preamble("ranks", grid.width, grid.height), Topic::chains};
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
    Panel p = grid.cell(i, 40, 10, 44, 8);
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
      cells_left_out(draws.names.size());
  return out;
}

}  // namespace sysid
