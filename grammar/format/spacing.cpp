// One walk over the tokens, with a stack of what the open brackets mean.
#include "grammar/format/spacing.hpp"

#include <algorithm>
#include <array>

#include "syntax/words.hpp"

namespace sysid::grammar {

namespace {

/// What stands inside a bracket: an expression, a unit, or the exponent of a unit, which is an expression without blanks.
enum class Inside { expression, unit, exponent };

/// Looser operators make better ends of lines.
struct OperatorPenalty {
  std::string_view symbol;
  int penalty;
};
constexpr std::array<OperatorPenalty, 14> break_before{{
    {"with", 0},
    {"then", 2},
    {"else", 2},
    {"or", 4},
    {"and", 6},
    {"<", 14},
    {"<=", 14},
    {">", 14},
    {">=", 14},
    {"==", 14},
    {"!=", 14},
    {"+", 16},
    {"-", 16},
    {"*", 40},
}};
constexpr int behind_comma = 10, behind_equals = 30, before_slash = 40, behind_parenthesis = 60, each_bracket = 25;

constexpr std::array<std::string_view, 9> declares_units{"time", "input",  "state",   "parameter", "constant",
                                                         "let",  "derive", "observe", "measure"};

bool is_symbol(Token const& token, std::string_view symbols) {
  return token.kind == TokenKind::symbol && token.text.size() == 1 && symbols.find(token.text[0]) != std::string_view::npos;
}
bool is_reserved(Token const& token) { return token.kind == TokenKind::word && words::contains(words::reserved, token.text); }
/// What a value may end with, so that a sign behind it is an operator.
bool ends_operand(Token const& token) {
  return (token.kind != TokenKind::symbol && !is_reserved(token)) || is_symbol(token, ")]'%");
}
bool begins_operand(Token const& token) { return token.kind != TokenKind::symbol || is_symbol(token, "(%"); }

class Walk {
 public:
  explicit Walk(std::span<Token const> tokens) : tokens_(tokens) {}

  std::vector<Piece> run() {
    std::vector<Piece> out;
    for (at_ = 0; at_ < tokens_.size(); ++at_) {
      bool const closes = is_symbol(token(), ")]");
      bool const sign = is_symbol(token(), "+-") && (at_ == 0 || !ends_operand(previous()));
      Piece piece;
      piece.text = token().text;
      piece.blank_before = at_ > 0 && blank();
      piece.break_penalty = at_ > 0 && token().joins_before && !sign ? penalty() : at_ > 0 ? behind_previous() : std::nullopt;
      if (closes && !inside_.empty()) inside_.pop_back();
      piece.depth = static_cast<int>(inside_.size());
      out.push_back(std::move(piece));
      if (is_symbol(token(), "([")) inside_.push_back(opened());
      equals_seen_ |= inside_.empty() && is_symbol(token(), "=~");
      sign_before_ = sign;
    }
    return out;
  }

 private:
  Token const& token() const { return tokens_[at_]; }
  Token const& previous() const { return tokens_[at_ - 1]; }
  Inside here() const { return inside_.empty() ? Inside::expression : inside_.back(); }

  bool opens_unit() const {
    if (previous().kind != TokenKind::word || previous().span.end != token().span.begin) return true;
    if (counts()) return false;
    // Directly behind a name: an index, but for the names that are being declared and for columns.
    if (!is_declaration(tokens_) || is_candidate() || !inside_.empty() || !words::contains(declares_units, tokens_[0].text))
      return false;
    return !equals_seen_ || tokens_[0].is("input") || tokens_[0].is("measure");
  }

  /// `state probability p[1]`: a candidate model of that name.
  bool is_candidate() const { return tokens_.size() > 2 && tokens_[1].is("probability") && begins_operand(tokens_[2]); }

  /// `[1]`, `[1, 2]`: an index wherever it stands, since no unit is a bare number behind a name.
  bool counts() const {
    return at_ + 2 < tokens_.size() && tokens_[at_ + 1].kind == TokenKind::number && is_symbol(tokens_[at_ + 2], "],");
  }

  Inside opened() const {
    if (token().is("[")) return at_ > 0 && opens_unit() ? Inside::unit : Inside::expression;
    if (here() != Inside::unit) return here();
    bool const behind_power = at_ > 0 && (previous().is("^") || (sign_before_ && at_ > 1 && tokens_[at_ - 2].is("^")));
    return behind_power ? Inside::exponent : Inside::unit;
  }

  bool blank() const {
    if (here() == Inside::unit && !token().is("]")) return ends_operand(previous()) && begins_operand(token());
    if (is_symbol(previous(), "([.^") || previous().is("..") || sign_before_) return false;
    if (is_symbol(token(), ")],;.'^") || token().is("..")) return false;
    if (token().is("(") && previous().kind == TokenKind::word) return !calls();
    if (token().is("[")) return opens_unit();
    if (is_symbol(token(), "*/") || is_symbol(previous(), "*/")) return false;
    // Two signs side by side are refused.
    if (is_symbol(token(), "+-") && is_symbol(previous(), "+-")) return true;
    return here() != Inside::exponent || !(is_symbol(token(), "+-") || is_symbol(previous(), "+-"));
  }

  /// The word before `(` is called, not one of the language's.
  bool calls() const {
    if (is_reserved(previous())) return false;
    if (previous().is("rows") && tokens_[0].is("split")) return false;
    bool const between = inside_.empty() && at_ > 1 && ends_operand(tokens_[at_ - 2]);
    return !between ||
           !(previous().is("with") || previous().is("probability") || words::contains(words::prepositions, previous().text));
  }

  std::optional<int> behind_previous() const {
    if (!token().joins_before || here() != Inside::expression) return std::nullopt;
    int const depth = static_cast<int>(inside_.size());
    if (previous().is(",")) return behind_comma + each_bracket * depth;
    if (previous().is("(") && !token().is(")")) return behind_parenthesis + each_bracket * depth;
    if (is_symbol(previous(), "=~") && depth == 0) return behind_equals;
    return std::nullopt;
  }

  std::optional<int> penalty() const {
    if (auto const behind = behind_previous()) return behind;
    if (here() != Inside::expression || token().kind == TokenKind::text || token().kind == TokenKind::number) return std::nullopt;
    int const brackets = each_bracket * static_cast<int>(inside_.size());
    if (token().is("with") && !inside_.empty()) return std::nullopt;
    if (token().is("/")) return before_slash + brackets;
    for (OperatorPenalty const& row : break_before)
      if (token().is(row.symbol)) return row.penalty + brackets;
    return std::nullopt;
  }

  std::span<Token const> tokens_;
  std::size_t at_ = 0;
  std::vector<Inside> inside_;
  bool equals_seen_ = false, sign_before_ = false;
};

}  // namespace

std::vector<Piece> spaced(std::span<Token const> tokens) { return Walk(tokens).run(); }

bool is_declaration(std::span<Token const> tokens) {
  return tokens.size() > 1 && tokens[0].kind == TokenKind::word && !is_reserved(tokens[0]) && tokens[1].kind != TokenKind::symbol &&
         !is_reserved(tokens[1]);
}

std::optional<Cells> cells_of(std::span<Token const> tokens, std::span<Piece const> pieces, int level) {
  if (level == 0) {
    if (tokens.size() < 2 || tokens[0].kind != TokenKind::word || !tokens[1].is("=")) return std::nullopt;
    return Cells{"", -1, 1};
  }
  if (!is_declaration(tokens)) return std::nullopt;
  Cells cells{std::string(tokens[0].text), -1, -1};
  for (std::size_t i = 1; i < tokens.size(); ++i) {
    if (pieces[i].depth > 0) continue;
    // A list of declared names is no row of a table.
    if (tokens[i].is(",")) return Cells{cells.keyword, -1, -1};
    if (tokens[i].is("[") && pieces[i].blank_before && cells.unit < 0) cells.unit = static_cast<int>(i);
    if (is_symbol(tokens[i], "=~")) {
      cells.sign = static_cast<int>(i);
      break;
    }
  }
  return cells;
}

}  // namespace sysid::grammar
