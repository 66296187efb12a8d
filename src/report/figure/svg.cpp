// Rewriting of text: what gnuplot writes is regular.
#include "report/figure/svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "core/text/number.hpp"

namespace sysid {
namespace {

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) text.replace(at, from.size(), to);
}

/// The value of the attribute that begins at `prefix` in a line, up to `end`.
std::string_view between(std::string_view line, std::string_view prefix, char end) {
  std::size_t const begin = line.find(prefix);
  if (begin == std::string_view::npos) return {};
  std::string_view const rest = line.substr(begin + prefix.size());
  return rest.substr(0, rest.find(end));
}

/// gnuplot writes a hundred bytes per filled point; a run of them is one path of round dots.
std::string join_points(std::string_view svg) {
  std::string out, points, scale, colour;
  auto const flush = [&] {
    if (points.empty()) return;
    out += fmt::format("\t<path stroke='{}' stroke-width='{:.2f}' stroke-linecap='round' d='{}'/>\n", colour,
                       2 * leading_number(scale), points);
    points.clear();
  };
  while (!svg.empty()) {
    std::size_t const end = std::min(svg.find('\n'), svg.size() - 1);
    std::string_view const line = svg.substr(0, end + 1);
    svg.remove_prefix(end + 1);
    if (!line.starts_with("\t<use xlink:href='#gpPt6'")) {
      flush();
      out += line;
      continue;
    }
    if (between(line, "scale(", ')') != scale || between(line, "color='", '\'') != colour) flush();
    scale = between(line, "scale(", ')');
    colour = between(line, "color='", '\'');
    points += fmt::format("M{}h.01", between(line, "translate(", ')'));
  }
  flush();
  return out;
}

/// Coordinates of paths and polygons to a tenth of a pixel: gnuplot writes hundredths, a seventh of a file.
std::string to_tenths(std::string_view svg) {
  auto const is_part = [](char c) { return (c >= '0' && c <= '9') || c == '.'; };
  std::string out;
  bool coordinates = false;
  for (std::size_t at = 0; at < svg.size();) {
    if (svg[at] == '\'') coordinates = !coordinates && (out.ends_with(" d=") || out.ends_with(" points = "));
    std::size_t end = at;
    while (coordinates && end < svg.size() && is_part(svg[end])) ++end;
    std::string_view const number = svg.substr(at, end - at);
    if (std::size_t const dot = number.find('.'); dot != number.npos && dot > 0 && dot + 3 == number.size()) {
      out += fmt::format("{:.1f}", leading_number(number));
      if (out.ends_with(".0")) out.resize(out.size() - 2);
    } else {
      end = std::max(end, at + 1);
      out += svg.substr(at, end - at);
    }
    at = end;
  }
  return out;
}

/// Numbers and titles that are empty; whether gnuplot writes such a title hangs on what it has drawn before.
void erase_empty_texts(std::string& svg) {
  constexpr std::string_view empty = ">\n\t\t<text></text>\n\t</g>\n";
  for (std::size_t at = 0; (at = svg.find(empty, at)) != std::string::npos;) {
    std::size_t const begin = svg.rfind("\t<g transform=", at);
    if (begin == std::string::npos || svg.find('\n', begin) < at) {
      ++at;
      continue;
    }
    bool const own_line = begin == 0 || svg[begin - 1] == '\n';
    svg.erase(begin, at + empty.size() - (own_line ? 0 : 1) - begin);
    at = begin;
  }
}

/// Removes what gnuplot writes for features that are not used, and makes its identifiers unique within a page.
void finish_svg(std::string& svg, std::string const& name) {
  svg = to_tenths(join_points(svg));
  std::size_t const begin = svg.find("<defs>"), end = svg.find("</defs>");
  if (begin != std::string::npos && end != std::string::npos && svg.find("<use", end) == std::string::npos)
    svg.erase(begin, end + 8 - begin);
  replace_all(svg, "\"gnuplot_canvas\"", "\"" + name + "_canvas\"");
  erase_empty_texts(svg);
  // Groups that hold nothing are most of the file's lines.
  for (std::size_t at = 0; (at = svg.find("<g fill=\"none\"", at)) != std::string::npos;) {
    std::size_t const end = svg.find('>', at);
    if (end != std::string::npos && svg.compare(end + 1, 6, "\n</g>\n") == 0)
      svg.erase(at, end + 7 - at);
    else
      at = end;
  }
  replace_all(svg, "font-family=\"Helvetica\"", "font-family=\"Helvetica, Arial, 'Liberation Sans', sans-serif\"");
}

/// "#1f2933" as gnuplot writes it: "rgb( 31,  41,  51)" for strokes, "rgb(31,41,51)" for text.
std::vector<std::string> as_written(std::string_view colour) {
  auto const channel = [&](std::size_t at) { return std::stoi(std::string(colour.substr(at, 2)), nullptr, 16); };
  int const red = channel(1), green = channel(3), blue = channel(5);
  return {fmt::format("rgb({:3}, {:3}, {:3})", red, green, blue), fmt::format("rgb({},{},{})", red, green, blue)};
}

}  // namespace

std::optional<std::string> finished_svg(std::string picture, plot::Figure const& figure) {
  if (picture.find("</svg>") == std::string::npos) return std::nullopt;
  finish_svg(picture, plot::identifier(figure.name));
  return picture;
}

std::string embedded(std::string const& svg, plot::Figure const& figure) {
  std::size_t const begin = svg.find("<svg");
  std::string out = begin == std::string::npos ? svg : svg.substr(begin);
  auto const follow = [&](std::string_view colour, std::string const& variable) {
    for (std::string const& form : as_written(colour)) replace_all(out, form, "var(--fig-" + variable + ")");
    replace_all(out, fmt::format("\"{}\"", colour), "\"var(--fig-" + variable + ")\"");
  };
  follow(plot::ink, "ink");
  follow(plot::muted, "muted");
  follow(plot::rule, "rule");
  follow(plot::paper, "paper");
  follow(plot::model, "model");
  follow(plot::response_band, "band");
  follow(plot::noise_band, "noise-band");
  follow(plot::data, "data");
  follow(plot::contrast, "contrast");
  for (std::size_t c = 0; c < std::size(plot::chains); ++c) follow(plot::chains[c], fmt::format("chain-{}", c + 1));
  std::size_t const box = out.find("viewBox=\"0 0 ");
  // Its text would otherwise be larger than the page's, or too small to be read: 9 pixels of its 12.
  double const width = box == std::string::npos ? 0 : leading_number(std::string_view(out).substr(box + 13));
  std::string const widest =
      width > 0 ? fmt::format(" style=\"max-width:{:.0f}px;min-width:{:.0f}px\"", 1.4 * width, 0.75 * width) : "";
  replace_all(out, "<svg ", fmt::format("<svg role=\"img\" aria-label=\"{}\"{}", plot::identifier(figure.name), widest));
  return out;
}

}  // namespace sysid
