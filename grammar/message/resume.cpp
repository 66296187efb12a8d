// Where parsing goes on behind a failure.
#include <algorithm>

#include "grammar/message/explain.hpp"
#include "syntax/words.hpp"

namespace sysid::grammar {

namespace {

std::uint32_t end_of(Layout const& layout, std::size_t token) { return token == 0 ? 0 : layout.tokens[token - 1].span.end; }

}  // namespace

std::uint32_t behind_statement(Layout const& layout, std::uint32_t where) {
  if (layout.ends_line(where)) return where;
  std::size_t const first = layout.token_at(where);
  int depth = 0;
  std::size_t i = first;
  for (; i < layout.tokens.size(); ++i) {
    Token const& token = layout.tokens[i];
    bool const ends_block = token.is("}") && (i == 0 || token.statement != layout.tokens[i - 1].statement);
    if (depth == 0 && (token.is(";") || ends_block)) break;
    if (depth == 0 && i > first && token.statement != layout.tokens[i - 1].statement) break;
    depth += token.is("{") ? 1 : token.is("}") ? -1 : 0;
  }
  return std::max(where, end_of(layout, i));
}

std::uint32_t behind_item(Layout const& layout, std::uint32_t where, std::string const& wanted) {
  std::size_t const found = layout.token_at(where);
  if (wanted == wanted::opening_brace) {
    // The body that follows the incomplete head goes with it, up to another block or the end. One without braces is told by its
    // first statement.
    int depth = 0;
    std::size_t i = found;
    for (; i < layout.tokens.size(); ++i) {
      Token const& token = layout.tokens[i];
      bool const next_block = depth == 0 && token.newline_before && words::contains(words::blocks, token.text);
      if (next_block) break;
      depth += token.is("{") ? 1 : token.is("}") ? -1 : 0;
      if (token.is("}") && depth <= 0) return token.span.end;
    }
    std::size_t const body = layout.ends_line(where) ? found : found + 1;
    bool const statements = body < i && layout.tokens[body].newline_before &&
                            (words::contains(words::model_statements, layout.tokens[body].text) ||
                             words::contains(words::data_statements, layout.tokens[body].text));
    if (statements) return end_of(layout, i);
  }
  std::uint32_t const end = behind_statement(layout, where);
  bool const stray_brace = end == where && found < layout.tokens.size() && layout.tokens[found].is("}") && !layout.ends_line(where);
  return stray_brace ? layout.tokens[found].span.end : end;
}

}  // namespace sysid::grammar
