// Script text for gnuplot 5. Every choice that gnuplot would make from the data (ranges, ticks, notation) is made here.
#include "report/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/number.hpp"

namespace sysid::plot {

double Axis::scaled(double value) const { return (value - origin) / std::pow(10.0, exponent); }
double Axis::unscaled(double number) const { return origin + number * std::pow(10.0, exponent); }
double Axis::scaled_width(double width) const { return width / std::pow(10.0, exponent); }

std::string series_colour(std::size_t index) {
  return fmt::format("lc rgb '{}' dt {}", chains[index % std::size(chains)], 1 + index / std::size(chains));
}

Axis axis(double low, double high, int count, double margin) {
  // What differs in its rounding alone is constant: ticks between could not be told apart, nor counted.
  if (!(high - low > 1e-12 * std::max(std::fabs(low), std::fabs(high)))) {
    double const around = low == 0 ? 1 : 0.05 * std::fabs(low);
    low -= around;
    high += around;
  }
  double const width = high - low;
  low -= margin * width;
  high += margin * width;
  Axis out;
  if (high - low < 1e-5 * std::max(std::fabs(low), std::fabs(high))) {
    // As many digits as all numbers in the range share, which is what the text says as well.
    double const digit = std::pow(10.0, std::ceil(std::log10(high - low)));
    out.origin = std::round((low + high) / 2 / digit) * digit;
    out.origin_text =
        pretty_number(fmt::format("{:.{}g}", out.origin, 2 + static_cast<int>(std::log10(std::fabs(out.origin) / digit))));
  }
  double const largest = std::max(std::fabs(low - out.origin), std::fabs(high - out.origin));
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

std::string axis_label(std::string_view name, std::string_view unit, Axis const& axis) {
  if (axis.origin_text.empty()) return axis_label(name, unit, axis.exponent);
  bool const below = axis.origin < 0;
  return axis_label(
      fmt::format("{} {} {}", name, below ? "+" : "−", below ? axis.origin_text.substr(std::string("−").size()) : axis.origin_text),
      unit, axis.exponent);
}

double text_pixels(std::string_view text) {
  return 6.7 * static_cast<double>(text_width(text));  // a little more than the mean advance of 12 pixels Helvetica
}

std::string shortened(std::string_view text, double pixels) {
  if (text_pixels(text) <= pixels) return std::string(text);
  std::size_t const bracket = text.ends_with(']') ? text.rfind(" [") : std::string_view::npos;
  std::string_view const unit = bracket == std::string_view::npos ? std::string_view{} : text.substr(bracket);
  std::string_view const name = text.substr(0, text.size() - unit.size());
  // Where whole characters begin. The last ones stay: they are what numbered names differ in.
  std::vector<std::size_t> begins;
  for (std::size_t i = 0; i < name.size(); ++i)
    if ((static_cast<unsigned char>(name[i]) & 0xC0U) != 0x80U) begins.push_back(i);
  std::size_t const tail = begins.size() > 8 ? 3 : 0;
  std::size_t head = begins.size() > tail ? begins.size() - tail - 1 : 0;
  auto const left = [&] {
    return fmt::format("{}…{}{}", name.substr(0, begins.empty() ? 0 : begins[head]),
                       tail == 0 ? "" : name.substr(begins[begins.size() - tail]), unit);
  };
  while (head > 2 && text_pixels(left()) > pixels) --head;
  return left();
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
  for (std::size_t at = 0; at < text.size();) {
    std::size_t const run = std::min(text.find_first_not_of('\'', at), text.size()) - at;
    // gnuplot 5 reads one doubled quote; two in a row it takes for an end.
    if (run > 1) out += fmt::format("'.\"{}\".'", text.substr(at, run));
    if (run == 1) out += "''";
    at += run;
    if (at < text.size() && text[at] != '\n' && text[at] != '\r') out += text[at];
    ++at;
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
  // Column width in print is 85 mm.
  double const inches = 85.0 / 25.4 / column_width, points = 72 * inches;
  // gnuplot's cairo terminals take a point for 4/3 of a pixel, and in PDF for two thirds of itself.
  std::string const shared = fmt::format("noenhanced background rgb '{}'", paper);
  std::string out = fmt::format(
      "# gnuplot {0}.gnuplot > {0}.svg draws this; gnuplot -e \"format='pdf'\" {0}.gnuplot > {0}.pdf as PDF, also 'png' and "
      "'text'\n"
      "if (!exists(\"format\")) format = 'svg'\n"
      "if (!exists(\"columns\")) columns = {1}\n"
      "set encoding utf8\n",
      name, width / 6);
  out += fmt::format("if (format eq 'svg') set terminal svg size {},{} dynamic font 'Helvetica,12' name '{}' {}\n", width, height,
                     identifier(name), shared);
  out += fmt::format(
      "if (format eq 'png') set terminal pngcairo size {},{} font 'Helvetica,9' fontscale 3 linewidth 3 pointscale 3 {}\n",
      3 * width, 3 * height, shared);
  out += fmt::format(
      "if (format eq 'pdf') set terminal pdfcairo size {:.4f}in,{:.4f}in font 'Helvetica,{:.2f}' linewidth {:.2f} "
      "pointscale {:.2f} {}\n",
      width * inches, height * inches, 1.5 * 12 * points, points, points, shared);
  // Characters are twice as high as wide.
  out += fmt::format("if (format eq 'text') set terminal dumb size columns,int(columns*{:.4f} + 0.5) noenhanced\n",
                     height / (2.0 * width));
  return out + fmt::format(
                   "set border 3 lw 1 lc rgb '{}'\n"
                   "set tics nomirror out scale 0.6 textcolor rgb '{}'\n"
                   "if (format ne 'text') set grid back lt 1 lw 1 lc rgb '{}'\n"
                   "set offsets 0,0,0,0\n"
                   "unset key\n"
                   "set multiplot\n",
                   muted, ink, rule);
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

namespace {

constexpr double sample = 22, gap = 6, between = 18, row_height = 15;  // pixels

double key_width(Key const& key) { return sample + gap + text_pixels(key.text); }

/// The keys of each row, as many as stand side by side.
std::vector<std::vector<Key>> legend_rows(std::vector<Key> const& keys, double room) {
  std::vector<std::vector<Key>> rows;
  double used = 0;
  for (Key key : keys) {
    key.text = shortened(key.text, room - sample - gap);
    double const width = key_width(key) + between;
    if (rows.empty() || used + width - between > room) {
      rows.emplace_back();
      used = 0;
    }
    rows.back().push_back(std::move(key));
    used += width;
  }
  return rows;
}

}  // namespace

std::string legend(std::vector<Key> const& keys, double left, double right, double y, int width, int height) {
  std::string out;
  int tag = 101;
  for (std::vector<Key> const& row : legend_rows(keys, right - left)) {
    double x = right + between;
    for (Key const& key : row) x -= key_width(key) + between;
    for (Key const& key : row) {
      auto const at = [&](double px, double py) { return fmt::format("screen {:.5f},{:.5f}", px / width, py / height); };
      switch (key.kind) {
        case Key::area:
          out += fmt::format("set object {} rectangle from {} to {} fc rgb '{}' fs solid noborder\n", tag, at(x, y - 5),
                             at(x + sample, y + 5), key.colour);
          break;
        case Key::line:
        case Key::dashes:
          out += fmt::format("set arrow {} from {} to {} nohead lw 1.6 dt {} lc rgb '{}'\n", tag, at(x, y), at(x + sample, y),
                             key.kind == Key::dashes ? "(6,4)" : "1", key.colour);
          break;
        case Key::points:
          out += fmt::format("set label {} '' at {} point pt 7 ps 0.4 lc rgb '{}'\n", tag + 100, at(x + sample / 2, y), key.colour);
          break;
      }
      out += fmt::format("set label {} {} at {} left textcolor rgb '{}'\n", tag, quote(key.text), at(x + sample + gap, y), ink);
      x += key_width(key) + between;
      ++tag;
    }
    y -= row_height;
  }
  return out;
}

int legend_height(std::vector<Key> const& keys, double left, double right) {
  return static_cast<int>(row_height * static_cast<double>(legend_rows(keys, right - left).size()));
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

void Axis::thin_numbers(double pixels, bool upright) {
  if (ticks.size() < 2) return;
  double const per_unit = pixels / (high - low);
  auto const room = [&](std::size_t i) { return upright ? 14 : text_pixels(ticks[i].second) + 7; };
  auto const fits = [&](std::size_t first, std::size_t stride) {
    for (std::size_t i = first; i + stride < ticks.size(); i += stride)
      if ((room(i) + room(i + stride)) / 2 > (ticks[i + stride].first - ticks[i].first) * per_unit) return false;
    return true;
  };
  // Where there is a zero it keeps its number.
  std::size_t zero = 0;
  for (std::size_t i = 0; i < ticks.size(); ++i)
    if (ticks[i].first == 0) zero = i;
  std::size_t stride = 1;
  while (stride < ticks.size() && !fits(zero % stride, stride)) ++stride;
  for (std::size_t i = 0; i < ticks.size(); ++i)
    if (i % stride != zero % stride) ticks[i].second.clear();
}

std::string panel(Panel const& asked, int width, int height) {
  Panel p = asked;
  p.x.thin_numbers(p.right - p.left, false);
  p.y.thin_numbers(p.top - p.bottom, true);
  double widest = 0;
  if (p.y_numbers)
    for (auto const& [place, number] : p.y.ticks) widest = std::max(widest, text_pixels(number));
  p.y_label_distance = std::max(p.y_label_distance, widest + 18);
  // Beyond the margins it would run into its neighbours.
  p.x_label = shortened(p.x_label, p.x_label_room > 0 ? p.x_label_room : p.right - p.left + 24);
  p.y_label = shortened(p.y_label, p.y_label_room > 0 ? p.y_label_room : p.top - p.bottom + 20);
  p.title = shortened(p.title, p.right - p.left + 24);
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
