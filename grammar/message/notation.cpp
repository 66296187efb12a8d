// Tables, and what the tokens before a colon tell.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>

#include "grammar/message/scan.hpp"
#include "syntax/words.hpp"

namespace sysid::grammar::notation {
namespace {

constexpr std::array<LookAlike, 36> look_alikes{{
    {"−", "`-`"},
    {"–", "`-`"},
    {"—", "`-`"},
    {"×", "`*`"},
    {"·", "`*`"},
    {"⋅", "`*`"},
    {"÷", "`/`"},
    {"≤", "`<=`"},
    {"≥", "`>=`"},
    {"≠", "`!=`"},
    {"′", "`'`"},
    {"’", "`'`"},
    {"‘", "`'`"},
    {"“", "`\"`"},
    {"”", "`\"`"},
    {"″", "`''`"},
    {"√", "`sqrt(...)`"},
    {"∞", "`inf`"},
    {"∙", "`*`"},
    {"∗", "`*`"},
    {"\u00a0", "a space"},
    {"\u202f", "a space"},
    {"\u2009", "a space"},
    {"\u200b", ""},
    {"…", "`..`"},
    {"½", "`0.5`"},
    {"¼", "`0.25`"},
    {"¾", "`0.75`"},
    {"ᵀ", "`transpose(...)`"},
    {"∂", "`y'` for a derivative"},
    {"±", "an uncertain value as a prior, such as `~ normal(20, sd = 5)`"},
    {"≈", "`=`"},
    {"∼", "`~`"},
    {"˜", "`~`"},
    {"～", "`~`"},
    {"∈", "a range of values as a prior, `~ uniform(0.1, 10)`"},
}};

/// Raised digits and signs, `⁻³`, with what they stand for.
constexpr std::array<LookAlike, 12> superscripts{{{"⁰", "0"},
                                                  {"¹", "1"},
                                                  {"²", "2"},
                                                  {"³", "3"},
                                                  {"⁴", "4"},
                                                  {"⁵", "5"},
                                                  {"⁶", "6"},
                                                  {"⁷", "7"},
                                                  {"⁸", "8"},
                                                  {"⁹", "9"},
                                                  {"⁻", "-"},
                                                  {"⁺", ""}}};

/// What commands of LaTeX are written as; all others without their `\\`.
constexpr std::array<LookAlike, 12> commands{{
    {"dot", "a derivative is written with primes: `y'`"},
    {"ddot", "a derivative is written with primes: `y''`"},
    {"cdot", "a product is written with `*`"},
    {"times", "a product is written with `*`"},
    {"frac", "a quotient is written with `/`: `(a)/(b)`"},
    {"dfrac", "a quotient is written with `/`: `(a)/(b)`"},
    {"left", "remove it: parentheses need no command"},
    {"right", "remove it: parentheses need no command"},
    {"quad", "remove it"},
    {"mathrm", "names are plain words: remove it"},
    {"text", "names are plain words: remove it"},
    {"partial", "a derivative is written with primes: `y'`"},
}};

constexpr std::array<Operator, 16> foreign_operators{{
    {"...", "remove it: a line continues after an operator or a comma, and inside parentheses"},
    {"**", "a power is written with `^`"},
    {".^", "powers are written with `^`"},
    {".*", "products are written with `*`"},
    {"./", "quotients are written with `/`"},
    {"~=", "write `!=`"},
    {"<>", "write `!=`"},
    {"+=", "a name cannot be given a second value: use another name"},
    {"-=", "a name cannot be given a second value: use another name"},
    {"*=", "a name cannot be given a second value: use another name"},
    {"/*", "a comment begins with `#` or `//` and ends with its line"},
    {"->", "an equation or a definition is written with `=`"},
    {":=", "an equation or a definition is written with `=`"},
    {"&&", "write `and`"},
    {"||", "write `or`"},
    {"!", "write `not`"},
}};

}  // namespace

LookAlike const* look_alike_at(std::string_view text) {
  if (text.empty() || static_cast<unsigned char>(text.front()) < 0x80U) return nullptr;
  auto const row =
      std::find_if(look_alikes.begin(), look_alikes.end(), [&](LookAlike const& each) { return text.starts_with(each.bytes); });
  return row == look_alikes.end() ? nullptr : &*row;
}

LookAlike const* superscript_at(std::string_view text) {
  if (text.empty() || static_cast<unsigned char>(text.front()) < 0x80U) return nullptr;
  auto const row =
      std::find_if(superscripts.begin(), superscripts.end(), [&](LookAlike const& each) { return text.starts_with(each.bytes); });
  return row == superscripts.end() ? nullptr : &*row;
}

Operator const* operator_at(std::string_view text) {
  auto const row = std::find_if(foreign_operators.begin(), foreign_operators.end(),
                                [&](Operator const& each) { return text.starts_with(each.symbol); });
  return row == foreign_operators.end() || (row->symbol == "!" && text.starts_with("!=")) ? nullptr : &*row;
}

bool is_command(std::string_view name) {
  return std::any_of(commands.begin(), commands.end(), [&](LookAlike const& each) { return each.bytes == name; });
}

std::string instead_of_command(std::string_view command) {
  for (LookAlike const& row : commands)
    if (row.bytes == command) return std::string(row.meant);
  return fmt::format("write `{}` without `\\`", command);
}

bool includes_file(std::string_view comment) {
  constexpr std::string_view word = "#include";
  if (!comment.starts_with(word)) return false;
  std::size_t const name = comment.find_first_not_of(' ', word.size());
  return name != std::string_view::npos && (comment[name] == '"' || comment[name] == '<');
}

std::string instead_of_unknown(std::vector<Token> const& tokens) {
  std::size_t first = tokens.size() - 1;
  while (first > 0 && !tokens[first].newline_before) --first;
  Token const& name = tokens[tokens.size() - 2];
  if (!tokens[first].is("initial") || name.kind != TokenKind::word)
    return "an unknown value has a prior: `parameter NAME ~ log_uniform(0.1, 10)`";
  std::string parameter(name.text.substr(0, name.text.find('\'')));
  parameter += name.text.ends_with('\'') ? "_rate0" : "0";
  return fmt::format("an unknown initial value is a parameter: `parameter {0} ~ normal(0, sd = 1)` and `initial {1} = {0}`",
                     parameter, name.text);
}

std::string instead_of_colon(std::string_view text, std::size_t begin, std::size_t end, bool first_of_line,
                             std::vector<Token> const& tokens) {
  if (end - begin == 2) return "a member of a part is written with a dot: `joint.force`";
  if (tokens.empty() || first_of_line) return "remove it";
  Token const& before = tokens.back();
  std::size_t digits_end = end;
  while (digits_end < text.size() && words::is_digit(text[digits_end])) ++digits_end;
  std::size_t statement = tokens.size() - 1;
  while (statement > 0 && !tokens[statement].newline_before) --statement;
  if (before.kind == TokenKind::number && tokens[statement].is("time"))
    return "equal steps have no column: write `step 0.02 [s]` in place of `time`";
  if (before.kind == TokenKind::number)
    return digits_end > end ? fmt::format("a range is written `{}..{}`", before.text, text.substr(end, digits_end - end))
                            : "a range is written `1..500`";
  std::size_t first = tokens.size() - 1;
  int depth = 0;
  for (std::size_t i = first; !tokens[i].newline_before && i > 0; first = --i)
    depth += tokens[i].is("(") ? 1 : tokens[i].is(")") ? -1 : 0;
  constexpr std::array<std::string_view, 3> of_columns{"time", "input", "measure"};
  if (depth > 0 && (before.is("(") || before.is(",")) && words::contains(of_columns, tokens[first].text))
    return "the name of a column is written in quotes unless it is a single word: `\"X(:,1)\"`";
  if (depth > 0 && before.kind == TokenKind::word) return fmt::format("a named argument is written `{} = ...`", before.text);
  constexpr std::array<std::string_view, 10> heads{"file",    "time",  "rate",  "step",   "split",
                                                   "initial", "state", "input", "shared", "equation"};
  if (first + 1 == tokens.size() && words::contains(heads, before.text)) return fmt::format("remove it: `{} ...`", before.text);
  if (before.is("else") || before.is("then")) return "remove it";
  if (first + 2 == tokens.size() && words::contains(words::blocks, tokens[first].text))
    return fmt::format("the body of a block stands in braces: `{} {} {{`", tokens[first].text, before.text);
  std::string_view line = text.substr(tokens[first].span.begin, begin - tokens[first].span.begin);
  while (line.ends_with(' ')) line.remove_suffix(1);
  return fmt::format("write `=`: `{} = ...`", line);
}

}  // namespace sysid::grammar::notation
