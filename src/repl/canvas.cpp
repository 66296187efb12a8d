// Two by four dots a character (Unicode 2800 to 28FF), eighths of a block for bars.
#include "repl/canvas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/text/number.hpp"
#include "core/text/utf8.hpp"

namespace sysid::repl {
namespace {

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void take(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool empty() const { return low > high; }
  /// With something on both sides of a single value.
  void widen() {
    if (high > low) return;
    double const by = low == 0 ? 1 : 0.5 * std::abs(low);
    low -= by;
    high += by;
  }
};

std::string utf8(std::uint32_t code) {
  return {static_cast<char>(0xE0 | (code >> 12)), static_cast<char>(0x80 | ((code >> 6) & 0x3F)),
          static_cast<char>(0x80 | (code & 0x3F))};
}

class Canvas {
 public:
  Canvas(PlotSize size, Range x, Range y)
      : size_(size), x_(x), y_(y), dots_(static_cast<std::size_t>(size.columns * size.rows), 0) {}

  void curve(Curve const& curve) {
    bool before = false;
    double from_x = 0, from_y = 0;
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      bool const there = std::isfinite(curve.x[i]) && std::isfinite(curve.y[i]);
      double const x = (curve.x[i] - x_.low) / (x_.high - x_.low) * (2 * size_.columns - 1);
      double const y = (y_.high - curve.y[i]) / (y_.high - y_.low) * (4 * size_.rows - 1);
      if (there && before && curve.joined) line(from_x, from_y, x, y);
      if (there) dot(x, y);
      before = there;
      from_x = x;
      from_y = y;
    }
  }

  std::string row(int r) const {
    // The bits of the dots of a character, from the top: left column, right column.
    std::string text;
    for (int c = 0; c < size_.columns; ++c) {
      std::uint8_t const bits = dots_[static_cast<std::size_t>(r * size_.columns + c)];
      text += bits == 0 ? " " : utf8(0x2800U + bits);
    }
    return text;
  }

 private:
  void dot(double x, double y) {
    static constexpr std::uint8_t bit[4][2] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};
    int const column = std::clamp(static_cast<int>(std::lround(x)), 0, 2 * size_.columns - 1);
    int const row = std::clamp(static_cast<int>(std::lround(y)), 0, 4 * size_.rows - 1);
    dots_[static_cast<std::size_t>(row / 4 * size_.columns + column / 2)] |= bit[row % 4][column % 2];
  }
  void line(double x0, double y0, double x1, double y1) {
    int const steps = static_cast<int>(std::ceil(std::max(std::abs(x1 - x0), std::abs(y1 - y0))));
    for (int s = 1; s < steps; ++s) dot(x0 + (x1 - x0) * s / steps, y0 + (y1 - y0) * s / steps);
  }

  PlotSize size_;
  Range x_, y_;
  std::vector<std::uint8_t> dots_;
};

std::string titled(AxisName const& axis) { return axis.unit.empty() ? axis.name : fmt::format("{} [{}]", axis.name, axis.unit); }

/// Both ends of an axis, with as many digits as place them to half a hundredth of it.
std::pair<std::string, std::string> ends_of(Range range) {
  double const near = 0.005 * (range.high - range.low);
  for (int digits = 4;; ++digits) {
    std::string low = significant(range.low, digits), high = significant(range.high, digits);
    bool const placed = std::fabs(leading_number(low) - range.low) <= near && std::fabs(leading_number(high) - range.high) <= near;
    if (placed || digits == 12) return {std::move(low), std::move(high)};
  }
}

/// Rows of a plot with the ends of both axes.
std::string framed(std::vector<std::string> const& rows, Range x, Range y, AxisName const& x_axis, AxisName const& y_axis,
                   int columns) {
  auto const [low, high] = ends_of(y);
  std::size_t const width = std::max(high.size(), low.size());
  std::string out = fmt::format("{:>{}}  {}\n", "", width, titled(y_axis));
  for (std::size_t r = 0; r < rows.size(); ++r) {
    std::string line = rows[r];
    while (line.ends_with(' ')) line.pop_back();
    out += fmt::format("{:>{}} {}{}\n", r == 0 ? high : r + 1 == rows.size() ? low : "", width, "\u2502", line);
  }
  std::string rule;
  for (int c = 0; c < columns; ++c) rule += "\u2500";
  out += fmt::format("{:>{}} \u2514{}\n", "", width, rule);
  auto const [left, right] = ends_of(x);
  std::string const title = titled(x_axis);
  int const gap = columns - static_cast<int>(left.size() + right.size()) - text_width(title);
  int const before = std::max(1, gap / 2);
  return out + fmt::format("{:>{}}  {}{:{}}{}{:{}}{}\n", "", width, left, "", before, title, "", std::max(1, gap - before), right);
}

}  // namespace

std::string plot_curves(std::vector<Curve> const& curves, AxisName const& x_axis, AxisName const& y_axis, PlotSize size) {
  Range x, y;
  for (Curve const& curve : curves)
    for (std::size_t i = 0; i < curve.x.size(); ++i)
      if (std::isfinite(curve.x[i]) && std::isfinite(curve.y[i])) {
        x.take(curve.x[i]);
        y.take(curve.y[i]);
      }
  if (x.empty() || y.empty()) return "";
  x.widen();
  y.widen();
  Canvas canvas(size, x, y);
  for (Curve const& curve : curves) canvas.curve(curve);
  std::vector<std::string> rows;
  for (int r = 0; r < size.rows; ++r) rows.push_back(canvas.row(r));
  return framed(rows, x, y, x_axis, y_axis, size.columns);
}

std::string plot_histogram(std::vector<double> const& values, AxisName const& x_axis, PlotSize size) {
  Range x;
  std::size_t finite = 0;
  for (double const value : values) {
    x.take(value);
    finite += std::isfinite(value) ? 1 : 0;
  }
  if (x.empty()) return "";
  x.widen();
  // As many bars as draws can fill, each of whole characters.
  int const wanted = std::clamp(static_cast<int>(2 * std::cbrt(static_cast<double>(finite)) + 1), 5, size.columns);
  int const bar = std::max(1, size.columns / wanted), bars = size.columns / bar;
  std::vector<int> count(static_cast<std::size_t>(bars), 0);
  for (double const value : values)
    if (std::isfinite(value))
      ++count[static_cast<std::size_t>(std::min(static_cast<int>((value - x.low) / (x.high - x.low) * bars), bars - 1))];
  Range y;
  y.low = 0;
  y.high = *std::max_element(count.begin(), count.end());
  static constexpr char const* block[9] = {" ", "\u2581", "\u2582", "\u2583", "\u2584", "\u2585", "\u2586", "\u2587", "\u2588"};
  std::vector<std::string> rows;
  for (int r = 0; r < size.rows; ++r) {
    std::string row;
    for (int const n : count) {
      int const eighths = static_cast<int>(std::lround(8.0 * size.rows * n / y.high)) - 8 * (size.rows - 1 - r);
      for (int c = 0; c < bar; ++c) row += block[std::clamp(eighths, 0, 8)];
    }
    rows.push_back(std::move(row));
  }
  return framed(rows, x, y, x_axis, {"draws", ""}, bars * bar);
}

}  // namespace sysid::repl
