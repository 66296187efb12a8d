// Statements by the layout's own rules about newlines.
#include "syntax/entry.hpp"

#include "grammar/message/layout.hpp"

namespace sysid {
namespace {

grammar::Layout lay_out(Source const& source) {
  Diagnostics ignored;
  return grammar::lay_out(source, ignored, 0);
}

int change_of_depth(grammar::Token const& token) {
  return token.is("{") || token.is("(") || token.is("[") ? 1 : token.is("}") || token.is(")") || token.is("]") ? -1 : 0;
}

}  // namespace

bool unfinished(std::string_view text) {
  // A word in the next line: it belongs to the statement when that has not ended.
  Source const source("", std::string(text) + "\nnext");
  grammar::Layout const layout = lay_out(source);
  int depth = 0;
  for (grammar::Token const& token : layout.tokens) depth += change_of_depth(token);
  return depth > 0 || (layout.tokens.size() > 1 && layout.tokens.back().joins_before);
}

std::vector<Span> top_level_statements(std::string_view text) {
  Source const source("", std::string(text));
  grammar::Layout const layout = lay_out(source);
  std::vector<Span> statements;
  int depth = 0, statement = -1;
  bool behind_block = false;
  for (grammar::Token const& token : layout.tokens) {
    bool const inside = depth > 0;
    depth += token.is("{") ? 1 : token.is("}") ? -1 : 0;
    bool const apart = token.is(";") && !inside;
    if (!apart && (statements.empty() || (!inside && (behind_block || token.statement != statement)))) {
      statements.push_back(token.span);
    } else if (!apart) {
      statements.back().end = token.span.end;
    }
    behind_block = inside && depth == 0;
    // A block's own statements have numbers of theirs; a `;` ends what came before it.
    statement = apart ? -1 : token.statement;
  }
  return statements;
}

std::string in_one_line(std::string_view text) {
  Source const source("", std::string(text));
  grammar::Layout const layout = lay_out(source);
  std::string line;
  grammar::Token const* before = nullptr;
  for (grammar::Token const& token : layout.tokens) {
    if (before != nullptr) {
      auto const gap = layout.text.substr(before->span.end, token.span.begin - before->span.end);
      bool const ends =
          gap.find('\n') != std::string::npos && !before->is("{") && !before->is(";") && !token.is("}") && !token.is(";");
      line += ends ? "; " : gap.empty() ? "" : " ";
    }
    line += token.text;
    before = &token;
  }
  return line;
}

}  // namespace sysid
