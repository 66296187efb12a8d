// Pieces of a page: tables, sections, figures, charts. All are well-formed XML as well as HTML.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "report/page/html.hpp"

namespace sysid {

/// Header and cells are HTML. The first cell of a row is its header; the first `words` columns and the last `last_words` are words,
/// the others numbers.
struct HtmlTable {
  std::string caption;  // words, not HTML
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
  std::size_t words = 1;
  std::size_t last_words = 0;
};
std::string html(HtmlTable const& table);

/// A part of a page with a heading; empty when it has no body.
struct HtmlSection {
  std::string id, title, body;  // words, words, HTML
  std::string kind = {};        // class names beside "part"
};
std::string html(HtmlSection const& section, int level);

/// Words as HTML: what stands in backquotes as code.
std::string marked(std::string_view words);
/// With a capital letter, where words begin and not a formula.
std::string capitalised(std::string words);
std::string paragraph(std::string_view words, std::string_view kind = {});
/// "k N/m" with the unit as units are shown.
std::string with_unit(std::string const& name, std::string const& unit);
/// A number as numbers are shown; other text as it is.
std::string number_html(std::string const& text);
std::string code(std::string_view text);
/// Text that is shown on demand, and always on paper.
std::string folded(std::string_view summary, std::string_view text);

/// A picture with its number and caption, under an id of its own; `number` counts within the page's task.
std::string figure_html(DrawnFigure const& drawn, std::string const& id, int number);

/// Where an interval lies within a wider one, on a logarithmic axis where the wide one is positive and spans more than a decade.
/// `words` says the same. Where an interval goes on beyond an end of the wide one an arrow stands there.
std::string range_chart(double wide_low, double wide_high, double low, double high, double mean, std::string_view words);

/// Bytes that are no UTF-8 and characters that XML has no place for, as replacement characters.
std::string legible(std::string_view text);

}  // namespace sysid
