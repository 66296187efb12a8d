// Lists in brackets or braces, as other languages have them, and what they are written as.
#include <fmt/format.h>

#include <array>

#include "grammar/message/hints.hpp"
#include "syntax/words.hpp"

namespace sysid::grammar {

namespace {

constexpr std::array<std::string_view, 4> lists_of_names{"state", "input", "time", "shared"};
constexpr std::array<std::string_view, 3> lists_of_terms{"target", "terms", "exclude"};

/// `((1, 0), (-1, 1))` of `[1, 0; -1, 1]`; empty where there is one row.
std::string matrix_by_rows(std::span<Token const> tokens, std::size_t opener, std::size_t close) {
  std::string rows, column;
  std::size_t first = opener + 1;
  int count = 0;
  bool single = true;  // numbers below each other
  for (std::size_t i = first; i <= close; ++i) {
    single = single && !tokens[i].is(",");
    if (!tokens[i].is(";") && i < close) continue;
    if (i > first) {
      std::string_view const row = written(tokens[first], tokens[i - 1]);
      rows += fmt::format("{}({})", ++count > 1 ? ", " : "", row);
      column += fmt::format("{}{}", count > 1 ? ", " : "", row);
    }
    first = i + 1;
  }
  return count > 1 ? fmt::format("({})", single ? column : rows) : std::string();
}

}  // namespace

std::size_t closing_on_line(std::span<Token const> tokens, std::size_t opener) {
  for (std::size_t i = opener + 1; i < tokens.size() && !tokens[i].newline_before; ++i) {
    if (tokens[i].is("]")) return i;
    if (tokens[i].is("[") || tokens[i].is("~") || tokens[i].is("=")) break;
  }
  return tokens.size();
}

std::string list_as_range(std::span<Token const> tokens, std::size_t opener, std::size_t close) {
  bool const several = close > opener + 3 && tokens[opener + 2].is(",") && tokens[opener + 1].kind == TokenKind::number &&
                       tokens[close - 1].kind == TokenKind::number;
  return several ? fmt::format("`~ uniform({}, {})`", tokens[opener + 1].text, tokens[close - 1].text) : "`~ uniform(1, 2)`";
}

std::string instead_of_list(std::span<Token const> tokens, std::size_t line, std::size_t opener) {
  std::size_t const close = closing_on_line(tokens, opener);
  bool const prior = tokens[line].is("parameter");
  std::string const general =
      prior ? fmt::format("a range of values is written as a prior: {}; a list is written in parentheses: `(1, 2)`",
                          list_as_range(tokens, opener, close))
            : "write it in parentheses: `(1, 2)`";
  if (tokens[line].is("initial")) return "an initial value names its state: `initial y = 0, y' = 0`";
  if (close == tokens.size() || close == opener + 1) return general;
  if (std::string const rows = matrix_by_rows(tokens, opener, close); !rows.empty())
    return fmt::format("{}: `{}`", rows.starts_with("((") ? "a matrix is a list of its rows" : "write it in parentheses", rows);
  std::string_view const inside = written(tokens[opener + 1], tokens[close - 1]);
  bool const behind_keyword = opener == line + 1;
  if (behind_keyword && words::contains(lists_of_names, tokens[line].text))
    return fmt::format("write it without brackets: `{} {}`", tokens[line].text, inside);
  if (opener == line + 2 && words::contains(lists_of_terms, tokens[line].text))
    return fmt::format("write it without brackets: `{} = {}`", tokens[line].text, inside);
  if (words::contains(words::prepositions, tokens[opener - 1].text))
    return fmt::format("list the data without brackets: `{} {}`", tokens[opener - 1].text, inside);
  bool const lone_argument = opener >= 2 && tokens[opener - 1].is("(") && tokens[opener - 2].kind == TokenKind::word &&
                             close + 1 < tokens.size() && tokens[close + 1].is(")");
  if (lone_argument) return fmt::format("arguments stand in parentheses alone: `{}({})`", tokens[opener - 2].text, inside);
  bool const unit = tokens[opener - 1].kind == TokenKind::word && words::contains(words::model_statements, tokens[line].text);
  if (unit) return "units are multiplied with a space or `*`: `[N s/m]`";
  return prior ? general : fmt::format("write it in parentheses: `({})`", inside);
}

}  // namespace sysid::grammar
