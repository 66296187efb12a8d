// The columns over time, one panel each.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "app/record/record_text.hpp"
#include "report/figure/drawing.hpp"

namespace sysid {
namespace {

using namespace plot;

constexpr std::size_t shown_columns = 8, most_stretches = 1000;

/// Rows as they are, or of each stretch of a long record the least and the largest value in their order: a line through them is a
/// curve where the values are one, and fills the range where they are noise.
Rows rows_of(std::vector<double> const& times, std::vector<double> const& values, Axis const& x, Axis const& y) {
  std::size_t const stretch = (values.size() + 2 * most_stretches - 1) / (2 * most_stretches), step = stretch > 1 ? 2 * stretch : 1;
  Rows rows;
  auto const add = [&](std::size_t i) { rows.push_back({x.scaled(times[i]), y.scaled(values[i])}); };
  for (std::size_t begin = 0; begin < values.size(); begin += step) {
    std::optional<std::size_t> low, high;
    for (std::size_t i = begin; i < std::min(begin + step, values.size()); ++i) {
      if (std::isnan(values[i])) continue;
      if (!low || values[i] < values[*low]) low = i;
      if (!high || values[i] > values[*high]) high = i;
    }
    if (!low) {
      rows.emplace_back();  // a gap breaks the line
      continue;
    }
    add(std::min(*low, *high));
    if (*low != *high) add(std::max(*low, *high));
  }
  return rows;
}

}  // namespace

plot::Figure record_figure(RecordLook const& look) {
  std::vector<std::size_t> shown;
  std::size_t all = 0;
  for (std::size_t c = 0; c < look.columns.size(); ++c) {
    ColumnLook const& column = look.columns[c];
    if (!column.unread.empty() || column.name == look.time.column || column.missing == column.rows) continue;
    if (++all <= shown_columns) shown.push_back(c);
  }
  constexpr int panel_height = 128, name_height = 20, below = 44, above = 4, width = 2 * column_width;
  Drawing drawing{"record", width, below + above + panel_height * static_cast<int>(std::max<std::size_t>(shown.size(), 1))};
  bool const has_time = !look.time.column.empty();
  for (std::size_t k = 0; k < shown.size(); ++k) {
    ColumnLook const& column = look.columns[shown[k]];
    double const top = drawing.height - above - panel_height * static_cast<double>(k);
    Axis const x = axis(look.times.front(), look.times.back(), 8);
    double const pad = column.dead ? std::max(std::fabs(column.smallest), 1.0) * 0.1 : 0;
    Axis const y = axis(column.smallest - pad, column.largest + pad, 3, 0.06);
    Panel p = panel_at(56, width - 14, top - panel_height + 8, top - name_height, x, y);
    p.x_numbers = k + 1 == shown.size();
    if (p.x_numbers) p.x_label = has_time ? axis_label("time", "s", x) : axis_label("row", "", x);
    // Above the panel a name has the width of the figure, beside it the height of the panel.
    p.title = axis_label(column.name, column.unit == "-" ? "" : column.unit, y);
    std::string const table = fmt::format("column{}", k);
    Rows rows = rows_of(look.times, look.values[shown[k]], x, y);
    std::vector<Series> series;
    series.push_back(line(table, 2, 1.0, plot::data));
    drawing.plots.push_back({std::move(p), {{table, std::move(rows)}}, std::move(series)});
  }
  Figure out{"record", look.file, "The columns of the record.", script(drawing), Topic::fit};
  if (all > shown.size()) out.caption += fmt::format(" Shown are the first {} of {}.", shown.size(), all);
  return out;
}

}  // namespace sysid
