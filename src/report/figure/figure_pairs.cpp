// Draws of each two parameters against each other.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "core/text/number.hpp"
#include "report/figure/axis.hpp"
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

/// An axis of a cell so many pixels wide: the fewest ticks of which two have numbers that stay clear of the neighbouring cells',
/// counted from the digits they share where the numbers are too long for that.
Axis cell_axis(std::pair<double, double> extent, int pixels) {
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

}  // namespace

Figure pair_figure(Draws const& draws) {
  // Draws of all chains, evenly thinned.
  std::vector<std::vector<double>> thinned(draws.names.size());
  std::size_t const stride = (static_cast<std::size_t>(draws.total()) + shown_draws - 1) / shown_draws;
  for (std::size_t i = 0; i < thinned.size(); ++i) {
    std::vector<double> const column = draws.column(i);
    for (std::size_t d = 0; d < column.size(); d += stride) thinned[i].push_back(column[d]);
  }
  std::vector<std::size_t> const parameters = shown_parameters(draws, thinned);
  std::size_t const count = parameters.size();
  std::vector<std::vector<double>> all(count), shown(count);
  for (std::size_t i = 0; i < count; ++i) {
    all[i] = draws.column(parameters[i]);
    shown[i] = std::move(thinned[parameters[i]]);
  }
  auto const label = [&](std::size_t i, Axis const& axis) {
    return axis_label(draws.names[parameters[i]], draws.units[parameters[i]], axis);
  };

  // Three stand in one column of print, more need the page.
  int const left = 70, bottom = 48, width = std::max(column_width, left + 6 + 110 * static_cast<int>(count));
  int const cell = (width - left - 6) / static_cast<int>(count);
  int const tall = std::min(cell, 110);
  int const height = bottom + tall * static_cast<int>(count) + 6;
  Figure out{"pairs", "Pairs", "", preamble("pairs", width, height)};
  std::vector<Axis> axes;
  for (std::size_t i = 0; i < count; ++i) axes.push_back(cell_axis(finite_range(all[i]), cell - 8));
  out.script += "set grid noxtics noytics\n";
  for (std::size_t row = 0; row < count; ++row) {
    for (std::size_t column = 0; column < count; ++column) {
      Panel p;
      p.left = left + static_cast<double>(column) * cell;
      p.right = p.left + cell - 8;
      p.top = height - 4.0 - static_cast<double>(row) * tall;
      p.bottom = p.top - tall + 8;
      p.x = axes[column];
      if (column > row) {
        double const r = correlation(all[row], all[column]);
        out.script +=
            fmt::format("set label 1 '{}' at screen {:.5f},{:.5f} center textcolor rgb '{}'\n",
                        std::isfinite(r) ? fmt::format("{}{:.2f}", r <= -0.005 ? "−" : "", std::fabs(r)) : "-",
                        (p.left + p.right) / 2 / width, (p.bottom + p.top) / 2 / height, std::fabs(r) >= 0.5 ? contrast : muted);
        out.script +=
            panel(p, width, height) + "unset border\nunset xtics\nunset ytics\nset xlabel ''\nplot NaN notitle\nunset label 1\n";
        continue;
      }
      bool const last = row + 1 == count;
      p.x_numbers = last;
      p.x_label_room = cell - 6;
      p.y_label_room = tall - 6;
      p.x_label = last ? label(column, p.x) : "";
      if (row == column) {
        constexpr std::size_t bins = 24;
        std::vector<double> counts(bins, 0);
        double const low = axes[row].low, extent = axes[row].high - low;
        for (double const v : all[row]) {
          if (!std::isfinite(v)) continue;
          ++counts[std::min(bins - 1, static_cast<std::size_t>((axes[row].scaled(v) - low) / extent * static_cast<double>(bins)))];
        }
        std::vector<std::vector<double>> outline;
        for (std::size_t b = 0; b < bins; ++b)
          for (std::size_t edge : {b, b + 1}) outline.push_back({low + extent * static_cast<double>(edge) / bins, counts[b]});
        p.y = {0, 1.08 * std::max(1.0, *std::max_element(counts.begin(), counts.end())), 0, {}};
        p.y_axis = false;
        out.script += data_block(fmt::format("h{}", row), outline) + panel(p, width, height);
        out.script += fmt::format(
            "plot $h{0} using 1:2 with filledcurves y1=0 fc rgb '{1}' fs noborder, $h{0} using 1:2 with lines lw 1 lc rgb '{2}'\n",
            row, response_band, model);
        continue;
      }
      p.y = axes[row];
      p.y_numbers = column == 0;
      p.y_label_distance = 54;
      p.y_label = column == 0 ? label(row, p.y) : "";
      std::vector<std::vector<double>> points;
      for (std::size_t d = 0; d < shown[row].size(); ++d)
        points.push_back({axes[column].scaled(shown[column][d]), axes[row].scaled(shown[row][d])});
      out.script += data_block(fmt::format("p{}_{}", row, column), points) + panel(p, width, height);
      out.script += fmt::format("plot $p{}_{} using 1:2 with points pt 7 ps 0.18 lc rgb '{}'\n", row, column, model);
    }
  }
  out.script += "unset multiplot\n";
  out.caption =
      "Draws of each two parameters, with their correlation above the diagonal. A narrow slanted cloud is a combination that the "
      "data determine "
      "where the two alone are not; separate clouds are several modes.";
  if (std::size_t const left_out = draws.names.size() - count; left_out > 0)
    out.caption += fmt::format(" Shown are {} of {}, {}; {} {} left out.", count, draws.names.size(),
                               static_cast<std::size_t>(draws.parameter_count) > count
                                   ? "those with the strongest correlations among the parameters"
                                   : "the first",
                               left_out, left_out == 1 ? "is" : "are");
  return out;
}

}  // namespace sysid
