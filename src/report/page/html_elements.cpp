// Elements as text.
#include "report/page/html_elements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "core/text/number.hpp"
#include "core/text/utf8.hpp"
#include "core/text/xml.hpp"
#include "report/figure/svg.hpp"
#include "report/text/report_text.hpp"

namespace sysid {

namespace {

/// Removes every element of this name, which has no element of the same name inside.
void remove_elements(std::string& text, std::string const& name) {
  std::string const open = "<" + name + ">", close = "</" + name + ">";
  for (std::size_t at = 0; (at = text.find(open, at)) != std::string::npos;) {
    std::size_t const end = text.find(close, at);
    if (end == std::string::npos) return;
    text.erase(at, end + close.size() - at);
  }
}

/// The value of each attribute `prefix"value"`, in either kind of quotes, replaced; nothing: the attribute is removed.
template <class Change>
void change_attributes(std::string& text, std::string const& prefix, Change const& change) {
  for (std::size_t at = 0; (at = text.find(prefix, at)) != std::string::npos;) {
    std::size_t const begin = at + prefix.size();
    std::size_t const end = begin < text.size() ? text.find(text[begin], begin + 1) : std::string::npos;
    if (end == std::string::npos) return;
    std::optional<std::string> const value = change(text.substr(begin + 1, end - begin - 1));
    std::string const attribute = value ? fmt::format("{}\"{}\"", prefix, *value) : std::string();
    text.replace(at, end + 1 - at, attribute);
    at += attribute.size();
  }
}

/// A picture as part of a page: gnuplot's own titles, which would show as tooltips, go; identifiers that something refers to are
/// kept apart from those of other pictures.
std::string own_picture(std::string svg, std::string const& id, std::string const& title) {
  remove_elements(svg, "title");
  remove_elements(svg, "desc");
  for (std::string const attribute : {" points", " fill"})
    for (std::size_t at = 0; (at = svg.find(attribute + " = '", at)) != std::string::npos;)
      svg.replace(at, attribute.size() + 3, attribute + "=");
  std::set<std::string> wanted;
  change_attributes(svg, " xlink:href=", [&](std::string const& target) {
    if (target.starts_with('#')) wanted.insert(target.substr(1));
    return target.starts_with('#') ? std::optional("#" + id + "-" + target.substr(1)) : std::nullopt;
  });
  change_attributes(
      svg, " id=", [&](std::string const& name) { return wanted.contains(name) ? std::optional(id + "-" + name) : std::nullopt; });
  std::size_t const begin = svg.find("<svg"), end = svg.find('>', begin);
  if (begin == std::string::npos || end == std::string::npos) return svg;
  std::string tag = svg.substr(begin, end - begin);
  for (char const* attribute : {" role=", " aria-label=", " aria-labelledby="})
    change_attributes(tag, attribute, [](std::string const&) { return std::optional<std::string>(); });
  tag.insert(4, fmt::format(" role=\"img\" aria-label=\"{}\" aria-describedby=\"{}-caption\"", escape(title), id));
  return svg.substr(0, begin) + tag + svg.substr(end);
}

}  // namespace

std::string html(HtmlTable const& table) {
  auto const row_html = [&](std::vector<std::string> const& row, bool header) {
    std::string out = "<tr>";
    for (std::size_t c = 0; c < row.size(); ++c) {
      char const* const kind =
          c < table.words || c + table.last_words >= std::max(row.size(), table.header.size()) ? "" : " class=\"n\"";
      if (header && row[c].empty())
        out += fmt::format("<td{}></td>", kind);
      else if (header || c == 0)
        out += fmt::format("<th scope=\"{}\"{}>{}</th>", header ? "col" : "row", kind, row[c]);
      else
        out += fmt::format("<td{}>{}</td>", kind, row[c]);
    }
    return out + "</tr>\n";
  };
  // A region that scrolls can be reached by the keyboard, and says what it is.
  std::string out = fmt::format(
      "<div class=\"scroll\" role=\"group\" tabindex=\"0\" aria-label=\"{0}\"><table{1}>\n<caption><span>{0}</span></caption>\n",
      escape(table.caption), table.last_words == 1 ? " class=\"said\"" : "");
  if (!table.header.empty()) out += "<thead>" + row_html(table.header, true) + "</thead>\n";
  out += "<tbody>\n";
  for (auto const& row : table.rows) out += row_html(row, false);
  return out + "</tbody></table></div>\n";
}

std::string html(HtmlSection const& section, int level) {
  if (section.body.empty()) return "";
  // Landmarks are few: the parts of the page, not those of its parts.
  std::string const landmark = level == 2 ? fmt::format(" aria-labelledby=\"{}-title\"", section.id) : "";
  return fmt::format("<section id=\"{0}\" class=\"part{1}\"{5}>\n<h{2} id=\"{0}-title\">{3}</h{2}>\n{4}</section>\n", section.id,
                     section.kind.empty() ? "" : " " + section.kind, level, escape(section.title), section.body, landmark);
}

std::string marked(std::string_view words) {
  std::string out;
  while (true) {
    std::size_t const begin = words.find('`');
    std::size_t const end = begin == words.npos ? words.npos : words.find('`', begin + 1);
    if (end == words.npos) return out + escape(words);
    out += escape(words.substr(0, begin)) + code(words.substr(begin + 1, end - begin - 1));
    words.remove_prefix(end + 1);
  }
}

std::string capitalised(std::string words) {
  auto const small = [](char c) { return c >= 'a' && c <= 'z'; };
  std::size_t letters = 0;
  while (letters < words.size() && small(words[letters])) ++letters;
  bool const word = letters >= 2 && (letters == words.size() || words.compare(letters, 2, ": ") == 0 ||
                                     (words[letters] == ' ' && words.compare(letters, 3, " = ") != 0));
  if (word) words[0] = static_cast<char>(words[0] - 'a' + 'A');
  return words;
}

std::string paragraph(std::string_view words, std::string_view kind) {
  if (words.empty()) return "";
  return fmt::format("<p{}>{}</p>\n", kind.empty() ? "" : fmt::format(" class=\"{}\"", kind), marked(words));
}

std::string with_unit(std::string const& name, std::string const& unit) {
  std::string const text = pretty_unit(unit);
  return escape(name) + (text.empty() || text == "-" ? "" : fmt::format(" <span class=\"unit\">{}</span>", escape(text)));
}

std::string number_html(std::string const& text) {
  double value = 0;
  auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  bool const number = error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
  if (number) return pretty_number(text);
  // "5.0184e9 ± 2.4e7", "< 1e-6".
  bool const numbers = text.find_first_of("0123456789") < 3 && text.find_first_of("\"`=") == std::string::npos;
  return escape(numbers ? pretty_numbers(text) : text);
}

std::string code(std::string_view text) { return fmt::format("<code>{}</code>", escape(text)); }

std::string folded(std::string_view summary, std::string_view text) {
  if (text.empty()) return "";
  // A line end behind the tag would be lost in HTML, not in XML: there is none.
  return fmt::format(
      "<details><summary>{0}</summary><pre tabindex=\"0\" role=\"group\" aria-label=\"{0}\"><code>{1}</code></pre></details>\n",
      escape(summary), escape(text));
}

std::string figure_html(DrawnFigure const& drawn, std::string const& id, int number) {
  return fmt::format("<figure id=\"{0}\">\n{1}<figcaption id=\"{0}-caption\"><b>Figure {2}.</b> {3}</figcaption>\n</figure>\n", id,
                     own_picture(embedded(*drawn.svg, drawn.figure), id, drawn.figure.title), number, marked(drawn.figure.caption));
}

std::string range_chart(double wide_low, double wide_high, double low, double high, double mean, std::string_view words) {
  constexpr double width = 130, height = 18, edge = 12;
  bool const logarithmic = wide_low > 0 && wide_high > 10 * wide_low;
  auto const place = [&](double value) {
    double share = (value - wide_low) / (wide_high - wide_low);
    if (logarithmic) share = value > 0 ? std::log(value / wide_low) / std::log(wide_high / wide_low) : 0;
    return edge + (width - 2 * edge) * std::clamp(share, 0.0, 1.0);
  };
  std::string marks;
  if (low < wide_high && high > wide_low) {
    double const from = place(low), to = std::max(place(high), from);
    // However narrow, it can be seen.
    double const bar = std::max(to - from, 2.5), left = std::clamp((from + to) / 2 - bar / 2, edge, width - edge - bar);
    marks += fmt::format("<rect class=\"narrow\" x=\"{:.1f}\" y=\"4\" width=\"{:.1f}\" height=\"10\"/>", left, bar);
  }
  // Beyond an end an arrow: what is clamped to the end would look as if it were inside. A hair is within what is drawn.
  double const hair = 0.01 * (wide_high - wide_low);
  if (low < wide_low - (logarithmic ? 0.01 * wide_low : hair))
    marks += fmt::format("<path class=\"narrow\" d=\"M{} 4v10l-8-5z\"/>", edge - 2);
  if (high > wide_high + hair) marks += fmt::format("<path class=\"narrow\" d=\"M{} 4v10l8-5z\"/>", width - edge + 2);
  if (mean >= wide_low && mean <= wide_high)
    marks += fmt::format("<rect class=\"mean\" x=\"{:.1f}\" y=\"2\" width=\"1.4\" height=\"14\"/>", place(mean) - 0.7);
  return fmt::format(
      "<svg class=\"range\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {} {}\"><rect class=\"wide\" x=\"{}\" y=\"7\" "
      "width=\"{}\" height=\"4\" rx=\"2\"/>{}</svg>",
      escape(words), width, height, edge, width - 2 * edge, marks);
}

std::string legible(std::string_view text) {
  auto const bytes = [&](std::size_t at) { return at < text.size() ? static_cast<unsigned char>(text[at]) : 0U; };
  auto const follows = [&](std::size_t at) { return at < text.size() && continues_character(text[at]); };
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    unsigned const first = bytes(i);
    std::size_t const length = first < 0x80 ? 1 : first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : first < 0xF5 ? 4 : 0;
    unsigned point = length == 1 ? first : first & (0xFFU >> (length + 1));
    bool whole = length > 0;
    for (std::size_t k = 1; k < length; ++k) {
      whole = whole && follows(i + k);
      point = point << 6U | (bytes(i + k) & 0x3FU);
    }
    bool const shortest = length < 3 || point >= (length == 3 ? 0x800U : 0x10000U);
    bool const character = (point >= 0x20 || point == '\t' || point == '\n' || point == '\r') && point != 0x7F &&
                           !(point >= 0x80 && point < 0xA0) && !(point >= 0xD800 && point < 0xE000) && point < 0x110000 &&
                           (point & 0xFFFEU) != 0xFFFEU;
    if (whole && shortest && character)
      out += text.substr(i, length);
    else
      out += "\xEF\xBF\xBD";
    i += whole ? length : 1;
  }
  return out;
}

}  // namespace sysid
