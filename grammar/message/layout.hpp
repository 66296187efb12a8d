// Which newlines end a statement. The rules get a text of the same length in which comments and the newlines inside a statement
// are blanks, so their skipper is a plain blank and every byte offset stays true.
#pragma once
#include <set>
#include <string>

#include "grammar/message/scan.hpp"

namespace sysid::grammar {

struct Layout {
  std::string text;
  std::vector<Token> tokens;
  std::vector<Span> comments;
  /// Statements in which a mistake is already reported, and whether one is reported at the end of the file: what the rules find
  /// there merely follows from it.
  std::set<int> reported;
  bool reported_at_end = false;

  /// The first token that ends behind `offset`; tokens.size() when there is none.
  std::size_t token_at(std::uint32_t offset) const;
  /// True when a newline that ends a statement, or the end of the file, stands between `offset` and the next token.
  bool ends_line(std::uint32_t offset) const;
};

/// Reports characters without meaning, brackets and texts without end, and statements too long to be handled; one mistake a
/// statement.
Layout lay_out(Source const& source, Diagnostics& diagnostics, std::size_t limit);

}  // namespace sysid::grammar
