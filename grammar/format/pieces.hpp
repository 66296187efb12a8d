// A text as the formatter sees it: statements made of pieces (tokens with the blanks between them and the places where a line may
// end), and comments.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "grammar/message/layout.hpp"

namespace sysid::grammar {

struct Comment {
  std::string text;
  bool own_line = false;
};

struct Piece {
  std::string text;
  bool blank_before = false;
  int depth = 0;                     // brackets around the gap before it
  std::optional<int> break_penalty;  // of ending the line before it; absent: the line may not end there
  std::vector<Comment> comments;     // in the gap before it: the line ends there
  int padding = 0;                   // blanks before it beyond `blank_before`
};

/// The columns of a declaration or a named task, as indices of pieces; -1: it has none.
struct Cells {
  std::string keyword;  // empty for a named task
  int unit = -1;
  int sign = -1;  // `~` or `=`
};

/// A statement with the comment behind it, or (without pieces) a comment on a line of its own.
struct Item {
  std::vector<Piece> pieces;
  std::string comment;
  bool under_previous = false;  // a comment in the column of the one behind the statement above
  bool blank_line_before = false;
  int level = 0;  // braces around it
  std::optional<Cells> cells;

  bool is(std::string_view only_token) const { return pieces.size() == 1 && pieces[0].text == only_token; }
  bool opens_block() const { return !pieces.empty() && pieces.back().text == "{"; }
};

/// The statements and comments of a text without syntax errors, in its order.
std::vector<Item> items_of(Source const& source, Layout const& layout);

}  // namespace sysid::grammar
