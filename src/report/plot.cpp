// Script text for gnuplot 5. Every choice that gnuplot would make from the data (ranges, ticks, notation) is made here.
#include "report/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/number.hpp"

namespace sysid::plot {

double Axis::scaled(double value) const { return value / std::pow(10.0, exponent); }

Axis axis(double low, double high, int count, double margin) {
  // What differs in its rounding alone is constant: ticks between could not be told apart, nor counted.
  if (!(high - low > 1e-9 * std::max(std::fabs(low), std::fabs(high)))) {
    double const around = low == 0 ? 1 : 0.05 * std::fabs(low);
    low -= around;
    high += around;
  }
  double const width = high - low;
  low -= margin * width;
  high += margin * width;
  Axis out;
  double const largest = std::max(std::fabs(low), std::fabs(high));
  int const power = static_cast<int>(std::floor(std::log10(largest)));
  if (power >= 4 || power <= -3) out.exponent = static_cast<int>(std::floor(power / 3.0)) * 3;
  out.low = out.scaled(low);
  out.high = out.scaled(high);
  double const rough = (out.high - out.low) / std::max(count, 1);
  double const unit = std::pow(10.0, std::floor(std::log10(rough)));
  auto const ticks_at = [&](double step) { return std::floor(out.high / step + 1e-9) - std::ceil(out.low / step - 1e-9) + 1; };
  double step = unit;
  // The finest that is no finer than asked for, as long as two ticks are left to read a scale from.
  for (double const factor : {2.0, 5.0, 10.0})
    if (step < 0.7 * rough && ticks_at(factor * unit) >= 2) step = factor * unit;
  int const decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  for (double k = std::ceil(out.low / step - 1e-9); k * step <= out.high + 1e-9 * step; ++k) {
    double const value = k == 0 ? 0 : k * step;
    // A real minus, as wide as a digit.
    out.ticks.emplace_back(value, fmt::format("{}{:.{}f}", value < 0 ? "−" : "", std::fabs(value), decimals));
  }
  return out;
}

namespace {

/// "mm" for 10⁻³ m: a power of ten as a prefix, where the unit is one that takes it.
std::string prefixed(std::string_view unit, int exponent) {
  static constexpr std::string_view takers[] = {"m", "s", "N", "V", "A", "W", "J", "Pa", "Hz"};
  static constexpr std::pair<int, std::string_view> prefixes[] = {{-9, "n"}, {-6, "µ"}, {-3, "m"}, {3, "k"}, {6, "M"}, {9, "G"}};
  if (std::find(std::begin(takers), std::end(takers), unit) == std::end(takers)) return "";
  for (auto const& [power, prefix] : prefixes)
    // Nobody counts in kiloseconds.
    if (power == exponent && !(unit == "s" && power > 0)) return std::string(prefix) + std::string(unit);
  return "";
}

}  // namespace

std::string axis_label(std::string_view name, std::string_view unit, int exponent) {
  if (std::string const unit_with_prefix = prefixed(unit, exponent); !unit_with_prefix.empty())
    return fmt::format("{} [{}]", name, unit_with_prefix);
  std::string inside = exponent == 0 ? "" : "10" + superscript(exponent);
  std::string const unit_text = pretty_unit(unit);
  if (!unit_text.empty() && unit_text != "-") inside += (inside.empty() ? "" : " ") + unit_text;
  return inside.empty() ? std::string(name) : fmt::format("{} [{}]", name, inside);
}

std::pair<double, double> range(std::vector<double> const& values) {
  std::pair<double, double> out(0, 1);
  bool first = true;
  for (double const v : values) {
    if (!std::isfinite(v)) continue;
    out = first ? std::pair(v, v) : std::pair(std::min(out.first, v), std::max(out.second, v));
    first = false;
  }
  return out;
}

std::pair<double, double> cover(std::pair<double, double> a, std::pair<double, double> b) {
  return {std::min(a.first, b.first), std::max(a.second, b.second)};
}

std::string quote(std::string_view text) {
  std::string out = "'";
  for (char const c : text) {
    if (c == '\n' || c == '\r') continue;
    if (c == '\'') out += '\'';
    out += c;
  }
  return out + "'";
}

std::string identifier(std::string_view text) {
  std::string out;
  for (char const c : text) {
    bool const plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    if (c == '\'')
      out += "_dot";
    else
      out += plain ? c : '_';
  }
  return out;
}

std::string preamble(std::string_view name, int width, int height) {
  return fmt::format(
      "set encoding utf8\n"
      "set terminal svg size {0},{1} dynamic noenhanced font 'Helvetica,12' name '{2}' background rgb '{3}'\n"
      "set border 3 lw 1 lc rgb '{4}'\n"
      "set tics nomirror out scale 0.6 textcolor rgb '{5}'\n"
      "set grid back lt 1 lw 1 lc rgb '{6}'\n"
      "set offsets 0,0,0,0\n"
      "unset key\n"
      "set multiplot\n",
      width, height, identifier(name), paper, muted, ink, rule);
}

std::string data_block(std::string_view name, std::vector<std::vector<double>> const& rows) {
  std::string out = fmt::format("${} << EOD\n", name);
  for (std::vector<double> const& row : rows) {
    // Seven digits are more than a figure shows.
    for (std::size_t c = 0; c < row.size(); ++c)
      out += std::isfinite(row[c]) ? fmt::format("{}{:.7g}", c == 0 ? "" : " ", row[c]) : fmt::format("{}NaN", c == 0 ? "" : " ");
    out += '\n';
  }
  return out + "EOD\n";
}

std::string legend(std::vector<Key> const& keys, double right, double y, int width, int height) {
  constexpr double sample = 22, gap = 6, between = 20, character = 6.1;  // pixels; character: the mean advance of 12 px Helvetica
  double x = right;
  for (Key const& key : keys) x -= sample + gap + character * text_width(key.text) + between;
  x += between;
  std::string out;
  int tag = 101;
  for (Key const& key : keys) {
    auto const at = [&](double px, double py) { return fmt::format("screen {:.5f},{:.5f}", px / width, py / height); };
    switch (key.kind) {
      case Key::area:
        out += fmt::format("set object {} rectangle from {} to {} fc rgb '{}' fs solid noborder\n", tag, at(x, y - 5),
                           at(x + sample, y + 5), key.colour);
        break;
      case Key::line:
        out += fmt::format("set arrow {} from {} to {} nohead lw 1.6 lc rgb '{}'\n", tag, at(x, y), at(x + sample, y), key.colour);
        break;
      case Key::points:
        out += fmt::format("set label {} '' at {} point pt 7 ps 0.4 lc rgb '{}'\n", tag + 100, at(x + sample / 2, y), key.colour);
        break;
    }
    out += fmt::format("set label {} {} at {} left textcolor rgb '{}'\n", tag, quote(key.text), at(x + sample + gap, y), ink);
    x += sample + gap + character * text_width(key.text) + between;
    ++tag;
  }
  return out;
}

std::string end_legend() { return "unset label\nunset arrow\nunset object\n"; }

namespace {

std::string tics(char which, Axis const& axis, bool numbers) {
  // gnuplot forgets `nomirror` when tics were off in the panel before.
  std::string out = fmt::format("set {}tics nomirror out scale 0.6 offset {} textcolor rgb '{}' (", which,
                                which == 'x' ? "0,0.45" : "0.5,0", ink);
  for (std::size_t i = 0; i < axis.ticks.size(); ++i)
    out += fmt::format("{}'{}' {:.10g}", i == 0 ? "" : ", ", numbers ? axis.ticks[i].second : "", axis.ticks[i].first);
  return out + ")\n";
}

}  // namespace

void Axis::reach_ticks() {
  if (ticks.size() < 2) return;
  double const step = ticks[1].first - ticks[0].first;
  double const next = ticks.back().first + step, slack = 0.02 * (high - low);
  if (next > high && next - high < slack) {
    high = next;
    std::string const& last = ticks.back().second;
    std::size_t const dot = last.find('.');
    ticks.emplace_back(next, fmt::format("{:.{}f}", next, dot == std::string::npos ? 0 : last.size() - dot - 1));
  }
}

void Axis::clear_edges(double share) {
  double const edge = share * (high - low);
  std::erase_if(ticks, [&](auto const& tick) { return tick.first < low + edge || tick.first > high - edge; });
}

Panel panel_at(double left, double right, double bottom, double top, Axis x, Axis y) {
  Panel p;
  p.left = left;
  p.right = right;
  p.bottom = bottom;
  p.top = top;
  p.x = std::move(x);
  p.y = std::move(y);
  return p;
}

std::string panel(Panel const& p, int width, int height) {
  std::string out = fmt::format(
      "set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\nset bmargin at screen {:.5f}\nset tmargin at screen {:.5f}\n",
      p.left / width, p.right / width, p.bottom / height, p.top / height);
  out += fmt::format("set xrange [{:.10g}:{:.10g}]\nset yrange [{:.10g}:{:.10g}]\n", p.x.low, p.x.high, p.y.low, p.y.high);
  out += tics('x', p.x, p.x_numbers);
  out += p.y_axis ? tics('y', p.y, p.y_numbers) : "unset ytics\n";
  out += fmt::format("set border {}\n", p.y_axis ? 3 : 1);
  out += fmt::format("set xlabel {} offset 0,{} textcolor rgb '{}'\n", quote(p.x_label), p.x_numbers ? "0.95" : "1.6", ink);
  // At one distance for all panels, whatever the width of the numbers.
  if (p.y_label.empty())
    out += "unset label 99\n";
  else
    out += fmt::format("set label 99 {} at screen {:.5f},{:.5f} center rotate by 90 textcolor rgb '{}'\n", quote(p.y_label),
                       (p.left - p.y_label_distance) / width, (p.bottom + p.top) / 2 / height, ink);
  out += fmt::format("set title {} offset 0,-0.7 textcolor rgb '{}'\n", quote(p.title), muted);
  return out;
}

}  // namespace sysid::plot
