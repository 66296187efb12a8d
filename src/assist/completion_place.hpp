// Where in a text a word is being written: the block, the statement so far, the brackets around it. By tokens, since the statement
// is not finished.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "grammar/message/scan.hpp"

namespace sysid::assist {

/// A bracket that is open where the word stands.
struct OpenBracket {
  char symbol = '(';
  std::string callee;    // the word before it; empty: none
  std::string argument;  // `sd` behind `sd =`; empty: none
  bool begins = false;   // nothing of the argument is written yet
};

struct CompletionPlace {
  Span word;         // what is written of it
  std::string path;  // `spring.` before it, without the last dot
  bool in_comment = false;
  bool in_text = false;                // `word` is then what stands behind the last / of the text,
  std::string folder;                  // and this stands before it
  std::string block;                   // "model", "data", ...; empty: none
  grammar::Token block_name;           // in the text up to the place
  std::vector<grammar::Token> before;  // of the statement
  std::vector<OpenBracket> brackets;   // outermost first
  std::string text;                    // up to the place: tokens point into it

  bool follows(std::string_view word) const { return !before.empty() && before.back().is(word); }
  bool has(std::string_view word) const;
  std::string_view first() const { return before.empty() ? std::string_view() : before.front().text; }
};

/// The place is the end of `text`; it keeps a copy that its tokens point into, so it is not copied or moved itself.
void find_place(std::string const& text, CompletionPlace& place);

}  // namespace sysid::assist
