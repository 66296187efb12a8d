// From tokens and comments to statements: which comment belongs to which, and where groups of statements end.
#include "grammar/format/pieces.hpp"

#include <algorithm>

#include "grammar/format/spacing.hpp"

namespace sysid::grammar {

namespace {

class Collector {
 public:
  Collector(Source const& source, Layout const& layout) : source_(source), layout_(layout) {}

  std::vector<Item> run() {
    std::vector<Token> const& tokens = layout_.tokens;
    std::size_t first = 0;
    while (first < tokens.size()) {
      if (tokens[first].is(";")) {
        after_ = tokens[first].span.end;
        ++first;
        continue;
      }
      std::size_t last = first + 1;
      auto const ends = [&](std::size_t i) {
        return tokens[i - 1].is("{") || tokens[i - 1].is("}") || tokens[i].is("}") || tokens[i].is(";") ||
               tokens[i].statement != tokens[first].statement;
      };
      while (last < tokens.size() && !ends(last)) ++last;
      statement(first, last);
      first = last;
    }
    comments_before(static_cast<std::uint32_t>(source_.text().size()));
    return std::move(out_);
  }

 private:
  void statement(std::size_t first, std::size_t last) {
    std::span<Token const> const tokens(layout_.tokens.data() + first, last - first);
    if (tokens[0].is("}") && level_ > 0) {
      comments_before(tokens[0].span.begin);
      --level_;
    } else {
      comments_before(tokens[0].span.begin);
    }
    // A `;` whose place no newline can take.
    if (tokens[0].joins_before && !out_.empty() && !out_.back().pieces.empty() && out_.back().level == level_) {
      Piece separator;
      separator.text = ";";
      out_.back().pieces.push_back(separator);
    }
    Item item;
    item.pieces = spaced(tokens);
    item.level = level_;
    item.cells = cells_of(tokens, item.pieces, level_);
    item.blank_line_before = lines_since(tokens[0].span.begin) > 1;
    after_ = tokens[0].span.end;
    for (std::size_t i = 1; i < tokens.size(); ++i) {
      for (; next_comment() < tokens[i].span.begin; ++comment_) {
        Span const span = layout_.comments[comment_];
        item.pieces[i].comments.push_back({text_of(span), lines_since(span.begin) > 0});
        after_ = span.end;
      }
      after_ = tokens[i].span.end;
    }
    if (tokens.back().is("{")) ++level_;
    out_.push_back(std::move(item));
  }

  std::uint32_t next_comment() const {
    return comment_ < layout_.comments.size() ? layout_.comments[comment_].begin : ~std::uint32_t{0};
  }

  /// Blanks at its end are no part of a comment.
  std::string text_of(Span span) const {
    std::string_view text = source_.text(span);
    while (!text.empty() && std::string_view(" \t\r\f\v").find(text.back()) != std::string_view::npos) text.remove_suffix(1);
    return std::string(text);
  }

  std::ptrdiff_t lines_since(std::uint32_t offset) const {
    std::string_view const between = source_.text().substr(after_, offset - after_);
    return std::count(between.begin(), between.end(), '\n');
  }

  /// The comments between two statements: one may stand behind the first, or continue the one that does.
  void comments_before(std::uint32_t offset) {
    for (; next_comment() < offset; ++comment_) {
      Span const span = layout_.comments[comment_];
      int const column = source_.place(span.begin).column;
      std::ptrdiff_t const lines = lines_since(span.begin);
      bool const statement_above = !out_.empty() && !out_.back().pieces.empty();
      bool const column_above = !out_.empty() && !out_.back().comment.empty() && (statement_above || out_.back().under_previous);
      if (lines == 0 && statement_above && out_.back().comment.empty()) {
        out_.back().comment = text_of(span);
      } else {
        Item item;
        item.comment = text_of(span);
        item.level = level_;
        item.under_previous = lines == 1 && column_above && column == column_ && out_.back().level == level_;
        item.blank_line_before = lines > 1;
        out_.push_back(std::move(item));
      }
      column_ = column;
      after_ = span.end;
    }
  }

  Source const& source_;
  Layout const& layout_;
  std::size_t comment_ = 0;
  std::uint32_t after_ = 0;  // where what has been seen ends
  int level_ = 0;
  int column_ = 0;  // of the last comment
  std::vector<Item> out_;
};

}  // namespace

std::vector<Item> items_of(Source const& source, Layout const& layout) { return Collector(source, layout).run(); }

}  // namespace sysid::grammar
