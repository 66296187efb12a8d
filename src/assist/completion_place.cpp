// The compiler's own scan and layout, with a word put in the place of the one being written.
#include "assist/completion_place.hpp"

#include <algorithm>

#include "grammar/message/layout.hpp"
#include "syntax/words.hpp"

namespace sysid::assist {
namespace {

using grammar::Token;
using grammar::TokenKind;

std::vector<OpenBracket> open_brackets(std::vector<Token> const& tokens) {
  std::vector<OpenBracket> open;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    Token const& token = tokens[i];
    if (token.is("(") || token.is("[")) {
      bool const called = i > 0 && tokens[i - 1].kind == TokenKind::word && tokens[i - 1].span.end == token.span.begin;
      open.push_back({token.text[0], called ? std::string(tokens[i - 1].text) : std::string(), {}, true});
    } else if ((token.is(")") || token.is("]")) && !open.empty()) {
      open.pop_back();
    } else if (open.empty()) {
      continue;
    } else if (token.is(",")) {
      open.back().argument.clear();
      open.back().begins = true;
    } else if (token.is("=") && i > 0) {
      open.back().argument = std::string(tokens[i - 1].text);
      open.back().begins = true;
    } else {
      open.back().begins = false;
    }
  }
  return open;
}

}  // namespace

bool CompletionPlace::has(std::string_view word) const {
  return std::any_of(before.begin(), before.end(), [&](Token const& token) { return token.is(word); });
}

void find_place(std::string const& text, CompletionPlace& place) {
  auto const end = static_cast<std::uint32_t>(text.size());
  grammar::Scan const scanned = grammar::scan(text);
  place.in_comment = !scanned.comments.empty() && scanned.comments.back().end == end;
  if (!scanned.tokens.empty() && scanned.tokens.back().kind == TokenKind::text && scanned.tokens.back().span.end == end) {
    std::string_view const written = scanned.tokens.back().text;
    place.in_text = written.size() == 1 || !written.ends_with('"');
    if (place.in_text) {
      std::size_t const slash = written.rfind('/');
      place.folder = slash == std::string_view::npos ? "" : written.substr(1, slash - 1);
      std::uint32_t const begin = scanned.tokens.back().span.begin;
      place.word = {begin + static_cast<std::uint32_t>(slash == std::string_view::npos ? 1 : slash + 1), end};
    }
  }
  if (place.in_comment) return;
  std::uint32_t begin = end;
  if (place.in_text) {
    begin = scanned.tokens.back().span.begin;
  } else {
    while (begin > 0 && words::continues_name(text[begin - 1])) --begin;
    place.word = {begin, end};
    std::uint32_t path = begin;
    while (path > 0 && (words::continues_name(text[path - 1]) || text[path - 1] == '.')) --path;
    if (path < begin) place.path = text.substr(path, begin - 1 - path);
  }
  place.text = text.substr(0, begin) + "x";
  Source const source("", place.text);
  Diagnostics unfinished;
  std::vector<Token> tokens = grammar::lay_out(source, unfinished, 0).tokens;
  for (Token& token : tokens) token.text = std::string_view(place.text).substr(token.span.begin, token.span.end - token.span.begin);
  std::vector<std::size_t> blocks;
  std::size_t first = 0;  // of the statement
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    if (i > 0 && tokens[i].statement != tokens[i - 1].statement) first = i;
    if (tokens[i].is("{")) blocks.push_back(first);
    if (tokens[i].is("}") && !blocks.empty()) blocks.pop_back();
  }
  if (tokens.empty()) return;
  if (!blocks.empty()) {
    place.block = std::string(tokens[blocks.back()].text);
    if (blocks.back() + 1 < tokens.size()) place.block_name = tokens[blocks.back() + 1];
  }
  place.before.assign(tokens.begin() + static_cast<std::ptrdiff_t>(first), tokens.end() - 1);
  place.brackets = open_brackets(place.before);
}

}  // namespace sysid::assist
