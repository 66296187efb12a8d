// The formatter's stages: pieces, columns, lines, comments behind lines; and the proof that nothing was lost.
#include "syntax/format.hpp"
#include "core/text/utf8.hpp"

#include "grammar/format/columns.hpp"
#include "grammar/format/line_breaks.hpp"
#include "grammar/format/pieces.hpp"
#include "syntax/parse.hpp"

namespace sysid {

namespace grammar {

namespace {

constexpr int before_comment = 2;

struct TextLine : Line {
  int level = 0;
  bool empty_before = false, under_previous = false;
};

/// Blocks stand apart from what stands beside them, with the comments right above them.
void set_blocks_apart(std::vector<Item>& items) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    bool const first_inside = i == 0 || items[i - 1].opens_block();
    if (first_inside || items[i].is("}")) items[i].blank_line_before = false;
    if (i > 0 && items[i - 1].is("}") && !items[i].is("}") && !items[i].under_previous) items[i].blank_line_before = true;
    if (!items[i].opens_block() || items[i].level > 0) continue;
    std::size_t head = i;
    while (head > 0 && !items[head].blank_line_before && items[head - 1].pieces.empty() && !items[head - 1].under_previous) --head;
    if (head > 0) items[head].blank_line_before = true;
  }
}

/// Comments behind neighbouring lines stand in one column, if it leaves them within the longest line.
void place_comments(std::vector<TextLine>& lines) {
  for (std::size_t first = 0; first < lines.size();) {
    std::size_t last = first;
    int column = 0, longest = 0;
    for (; last < lines.size() && !lines[last].comment.empty() && lines[last].level == lines[first].level &&
           (last == first || !lines[last].empty_before);
         ++last) {
      column = std::max(column, lines[last].under_previous ? 0 : text_width(lines[last].code) + before_comment);
      longest = std::max(longest, text_width(lines[last].comment));
    }
    bool const one_column = column + longest <= longest_line;
    int own = 0;
    for (std::size_t i = first; i < last; ++i) {
      if (!lines[i].under_previous) own = text_width(lines[i].code) + before_comment;
      lines[i].code.append(static_cast<std::size_t>((one_column ? column : own) - text_width(lines[i].code)), ' ');
      lines[i].code += lines[i].comment;
    }
    first = std::max(last, first + 1);
  }
}

std::string laid_out(std::vector<Item> items) {
  set_blocks_apart(items);
  align(items);
  std::vector<TextLine> lines;
  for (Item const& item : items) {
    std::size_t const first = lines.size();
    if (item.under_previous) {
      lines.push_back({{"", item.comment}, item.level, false, true});
    } else {
      for (Line& line : lines_of(item)) lines.push_back({std::move(line), item.level});
      if (!item.pieces.empty()) lines.back().comment = item.comment;
    }
    lines[first].empty_before = item.blank_line_before;
  }
  place_comments(lines);
  std::string out;
  for (TextLine const& line : lines) out += (line.empty_before ? "\n" : "") + line.code + '\n';
  return out;
}

/// The layout of a text that has been parsed.
Layout layout_of(Source const& source) {
  Diagnostics none;
  return lay_out(source, none, 1);
}

std::vector<std::string> comments_of(Source const& source) {
  std::vector<std::string> out;
  for (Item const& item : items_of(source, layout_of(source))) {
    for (Piece const& piece : item.pieces)
      for (Comment const& comment : piece.comments) out.push_back(comment.text);
    if (!item.comment.empty()) out.push_back(item.comment);
  }
  return out;
}

}  // namespace

}  // namespace grammar

std::optional<std::string> formatted(Source const& source, Diagnostics& diagnostics) {
  auto const tree = parse(source, diagnostics);
  if (!tree) return std::nullopt;
  std::string text = grammar::laid_out(grammar::items_of(source, grammar::layout_of(source)));
  Source const result(source.name(), text);
  Diagnostics none;
  if (parse(result, none) != tree || grammar::comments_of(result) != grammar::comments_of(source))
    throw InternalError("the canonical layout would change the meaning of this file");
  return text;
}

}  // namespace sysid
