// Script text for gnuplot 5. Every choice that gnuplot would make from the data (ranges, ticks, notation) is made here and in
// report/figure/axis.
#include "report/figure/plot.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/text/number.hpp"
#include "core/text/utf8.hpp"

namespace sysid::plot {

std::string series_colour(std::size_t index) {
  return fmt::format("lc rgb '{}' dt {}", chains[index % std::size(chains)], 1 + index / std::size(chains));
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
    if (!continues_character(name[i])) begins.push_back(i);
  std::size_t const tail = begins.size() > 8 ? 3 : 0;
  std::size_t head = begins.size() > tail ? begins.size() - tail - 1 : 0;
  auto const left = [&] {
    return fmt::format("{}…{}{}", name.substr(0, begins.empty() ? 0 : begins[head]),
                       tail == 0 ? "" : name.substr(begins[begins.size() - tail]), unit);
  };
  bool const counted = name.find(" − ") != name.npos || name.find(" + ") != name.npos;  // from a number, which has to stay
  while (head > 2 && text_pixels(left()) > pixels) --head;
  if ((text_pixels(left()) <= pixels && !counted) || unit.empty()) return left();
  // Of a short name nothing would be left: rather less of the unit, but for the power of ten, without which numbers are wrong.
  std::size_t const power = unit.starts_with(" [10") ? unit.find(' ', 1) : std::string_view::npos;
  std::string const rest = power == std::string_view::npos ? " […]" : std::string(unit.substr(0, power)) + " …]";
  if (text_pixels(name) + text_pixels(rest) <= pixels) return std::string(name) + rest;
  return counted ? std::string(name) + (power == std::string_view::npos ? "" : std::string(unit.substr(0, power)) + "]") : left();
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

std::string preamble(std::string_view name, int width, int height, int lines) {
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
  out += fmt::format("if (format eq 'text') set terminal dumb size columns,{} noenhanced\n",
                     lines > 0 ? std::to_string(lines) : fmt::format("int(columns*{:.4f} + 0.5)", height / (2.0 * width)));
  return out + fmt::format(
                   "set border 3 lw 1 lc rgb '{}'\n"
                   "set tics nomirror out scale 0.6 textcolor rgb '{}'\n"
                   "if (format ne 'text') set grid back lt 1 lw 1 lc rgb '{}'\n"
                   "set offsets 0,0,0,0\n"
                   "unset key\n"
                   "set multiplot\n",
                   muted, ink, rule);
}

void rename(Figure& figure, std::string const& name) {
  // The last line of the preamble that has the name is that of the SVG.
  std::size_t const end = std::min(figure.script.find('\n', figure.script.find("set terminal svg")), figure.script.size());
  std::string head = figure.script.substr(0, end);
  auto const replace = [&](std::string const& from, std::string const& to) {
    for (std::size_t at = head.find(from); at != std::string::npos; at = head.find(from, at + to.size()))
      head.replace(at, from.size(), to);
  };
  replace(fmt::format(" {}.", figure.name), fmt::format(" {}.", name));
  replace(fmt::format("name '{}'", identifier(figure.name)), fmt::format("name '{}'", identifier(name)));
  figure.script.replace(0, end, head);
  figure.name = name;
}

std::string data_block(std::string_view name, std::vector<std::vector<double>> const& rows) {
  std::string out = fmt::format("${} << EOD\n", name);
  for (std::vector<double> const& row : rows) {
    // Seven digits are more than a figure shows.
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (c > 0) out += ' ';
      if (std::isfinite(row[c]))
        fmt::format_to(std::back_inserter(out), FMT_COMPILE("{:.7g}"), row[c]);
      else
        out += "NaN";
    }
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
        case Key::circles:
          out += fmt::format("set label {} '' at {} point pt {} ps {} lc rgb '{}'\n", tag + 100, at(x + sample / 2, y),
                             key.kind == Key::points ? 7 : 6, key.kind == Key::points ? 0.4 : 0.55, key.colour);
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
    out += fmt::format(
        "if (format eq 'text') set label 99 {0} at screen {1:.5f},{2:.5f} left norotate offset 2,0.5; else "
        "set label 99 {0} at screen {3:.5f},{4:.5f} center rotate by 90 offset 0,0 textcolor rgb '{5}'\n",
        quote(p.y_label), p.left / width, p.top / height, (p.left - p.y_label_distance) / width, (p.bottom + p.top) / 2 / height,
        ink);
  out += fmt::format("set title {} offset 0,-0.7 textcolor rgb '{}'\n", quote(p.title), muted);
  return out;
}

}  // namespace sysid::plot
