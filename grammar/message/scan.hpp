// A light scan of the text into tokens, for two purposes only: to decide which newlines end a statement, and to word messages.
// The language itself is parsed by the X3 rules. Mistakes that concern single characters are found here.
#pragma once
#include <string>
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

/// Signs of word processors, formulas and other languages, and what stands for them here.
namespace notation {

/// A character, or a command, and what the language writes.
struct LookAlike {
  std::string_view bytes, meant;
};
/// An operator of another language.
struct Operator {
  std::string_view symbol, help;
};

/// The row that `text` begins with, or null.
LookAlike const* look_alike_at(std::string_view text);
/// A raised digit or sign, with the one that it stands for.
LookAlike const* superscript_at(std::string_view text);
Operator const* operator_at(std::string_view text);

/// Whether it is a command of LaTeX with something in its place here.
bool is_command(std::string_view name);
/// Help about a command of LaTeX, without its `\\`.
std::string instead_of_command(std::string_view command);
/// Of a comment: whether it is `#include "FILE"` or `#include <FILE>`.
bool includes_file(std::string_view comment);
/// Help about `initial y = ?`, by the tokens before the question mark.
std::string instead_of_unknown(std::vector<Token> const& tokens);
/// Help about a colon from `begin` to `end` of the text, by the tokens before it. first: nothing stands before it on its line.
std::string instead_of_colon(std::string_view text, std::size_t begin, std::size_t end, bool first,
                             std::vector<Token> const& tokens);

}  // namespace notation

}  // namespace sysid::grammar
