// A light scan of the text into tokens, for two purposes only: to decide which newlines end a statement, and to word messages.
// The language itself is parsed by the X3 rules. Mistakes that concern single characters are found here.
#pragma once
#include <string_view>
#include <vector>

#include "core/text/diagnostic.hpp"

namespace sysid::grammar {

enum class TokenKind { word, number, text, symbol };

struct Token {
  TokenKind kind = TokenKind::symbol;
  Span span;
  std::string_view text;
  bool newline_before = false;
  /// Counts the statements of the file; filled by the layout.
  int statement = 0;
  /// A newline before this token would not end a statement (for the first behind `;`: would not end the one before). Filled by the
  /// layout.
  bool joins_before = false;

  bool is(std::string_view symbol_or_word) const { return kind != TokenKind::text && text == symbol_or_word; }
};

/// A diagnostic and the token it belongs to.
struct Mistake {
  std::size_t token;
  Diagnostic diagnostic;
};

struct Scan {
  std::vector<Token> tokens;
  std::vector<Span> comments;
  std::vector<Mistake> mistakes;
};

/// Total: any bytes give tokens that cover everything but blanks, newlines and comments.
Scan scan(std::string_view text);

}  // namespace sysid::grammar
