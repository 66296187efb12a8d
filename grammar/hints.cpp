// A table of situations, first match wins.
#include "grammar/hints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "grammar/explain.hpp"
#include "syntax/words.hpp"

namespace sysid::grammar {

namespace {

struct Situation {
  bool (*holds)(Gap const&);
  char const* help;
};

constexpr std::array<std::string_view, 7> types{"Real", "real", "double", "float", "int", "Integer", "var"};
constexpr std::array<std::string_view, 6> means_with{"using", "by", "via", "where", "options", "given"};

bool found(Gap const& gap, std::string_view text) { return gap.found != nullptr && gap.found->is(text); }
bool found_kind(Gap const& gap, TokenKind kind) { return gap.found != nullptr && gap.found->kind == kind; }
bool declares(Gap const& gap) {
  return gap.begins_with("parameter") || gap.begins_with("state") || gap.begins_with("input") || gap.begins_with("constant");
}
bool begins_with_verb(Gap const& gap) {
  std::size_t const verb = gap.statement.size() > 2 && gap.statement[1].is("=") ? 2 : 0;
  return gap.statement.size() > verb && words::contains(words::verbs, gap.statement[verb].text);
}

constexpr std::array<Situation, 29> situations{{
    {[](Gap const& g) { return g.begins_with("parameter") && found(g, "~"); },
     "in a dictionary a parameter is unknown or has a value, but no prior: `parameter m [kg]`, `parameter m [kg] = 1`"},
    {[](Gap const& g) { return g.begins_with("parameter") && found(g, "in"); },
     "a prior is written `parameter name ~ uniform(lower, upper)`"},
    {[](Gap const& g) { return g.wanted.starts_with("a distribution"); },
     "write the distribution of the data around the model: `~ normal(y, sd = sigma)`"},
    {[](Gap const& g) { return g.wanted == wanted::name && g.begins_with("model") && found(g, "{"); },
     "a model has a name: `model oscillator {`"},
    {[](Gap const& g) { return g.begins_with("split"); }, "rows are written `split train = rows 1..500`"},
    {[](Gap const& g) { return g.wanted == "a text in quotes" || (found(g, "'") && g.begins_with("file")); },
     "a text is written in double quotes on one line: `file \"measured.csv\"`"},
    {[](Gap const& g) {
       return g.begins_with("input") && g.wanted == wanted::end_of_statement && g.at > 3 && found_kind(g, TokenKind::word);
     },
     "the rule between samples is written after `hold`: `hold linear`"},
    {[](Gap const& g) { return found(g, "elseif") || found(g, "elif") || found(g, "elsif"); }, "write `else if`"},
    {[](Gap const& g) { return g.wanted == "`else`"; }, "every `if` has an `else`: the value where the condition does not hold"},
    {[](Gap const& g) { return found(g, "if") && g.wanted != wanted::name && g.wanted != wanted::column; },
     "a value that depends on a condition is written `if condition then value else value`"},
    {[](Gap const& g) { return found(g, "[") && g.wanted == wanted::value; }, "a list is written in parentheses: `(1, 2)`"},
    {[](Gap const& g) { return found(g, ".") && (g.wanted == "`]`" || g.wanted == "']'"); },
     "units are multiplied with a blank or `*`: `[N s/m]`"},
    {[](Gap const& g) { return (g.wanted == "`]`" || g.wanted == "']'") && found(g, ","); },
     "units are multiplied with a blank or `*`: `[N s/m]`"},
    {[](Gap const& g) { return (g.wanted == "`]`" || g.wanted == "']'") && found(g, "-"); },
     "units are multiplied with a blank or `*`, a power is written with `^`: `[N s/m]`, `[m s^-2]`"},
    {[](Gap const& g) { return found(g, "=") && g.at == 0; }, "an equation has two sides: `left = right`"},
    {[](Gap const& g) { return found(g, "%") && g.at == 0; }, "a comment begins with `#` or `//`"},
    {[](Gap const& g) { return g.begins_with("initial") && g.wanted == wanted::equals && found(g, "("); },
     "write an initial value without the time: `initial y = 0`"},
    {[](Gap const& g) { return declares(g) && g.wanted == "')'" && found(g, "="); },
     "write a unit in brackets, an initial value as `initial y = 0`, and a bound as `lower = 0` inside the prior"},
    {[](Gap const& g) {
       return declares(g) && g.statement.size() > 2 && g.statement[2].is("(") && g.wanted == wanted::operator_between;
     },
     "a unit is written in brackets: `[N s/m]`"},
    {[](Gap const& g) { return g.begins_with("function") && g.wanted == "'('"; }, "a function is written `function f(a, b) = a*b`"},
    {[](Gap const& g) { return found(g, "(") && g.wanted == wanted::name && begins_with_verb(g); },
     "a task is written `fit MODEL to DATA with mh(samples = 1000)`"},
    {[](Gap const& g) {
       return g.wanted == wanted::preposition_or_end && found_kind(g, TokenKind::word) &&
              !words::contains(means_with, g.found->text);
     },
     "a model is fitted `to` data, a fit predicts `on` data: `fit MODEL to DATA`"},
    {[](Gap const& g) {
       return (g.wanted == wanted::with_or_end || g.wanted == wanted::preposition_or_end) && found_kind(g, TokenKind::word) &&
              words::contains(means_with, g.found->text);
     },
     "did you mean `with`?"},
    {[](Gap const& g) { return g.wanted == wanted::verb && g.found != nullptr && g.found->kind != TokenKind::word && g.at == 2; },
     "outside of blocks `NAME =` begins a task; declare quantities inside a model: `constant g = 9.81 [m/s^2]`"},
    {[](Gap const& g) { return g.wanted == wanted::end_of_statement && found(g, ",") && g.begins_with("parameter"); },
     "declare each parameter in a statement of its own, without a start value: the fit chooses the start"},
    {[](Gap const& g) { return g.wanted == wanted::end_of_statement && found(g, ","); }, "begin a new line, or write `;`"},
    {[](Gap const& g) { return g.wanted == wanted::equals && g.found == nullptr; },
     "an equation has two sides: `left = right`; a definition is written `let name = value`"},
    {[](Gap const& g) { return g.wanted == wanted::opening_brace && g.begins_with("model"); },
     "a model is written `model name { ... }`; a name is made of letters, digits and `_`"},
    {[](Gap const& g) { return g.before() != nullptr && g.before(2) != nullptr && g.before(2)->is(".") && found(g, "("); },
     "write the function without a module before it"},
}};

/// `1_000` without its underscores, or empty.
std::string grouped_digits(Gap const& gap) {
  Token const* const number = gap.before();
  if (number == nullptr || number->kind != TokenKind::number || !found_kind(gap, TokenKind::word)) return {};
  std::string digits(number->text);
  for (char const c : gap.found->text) {
    if (c != '_' && !words::is_digit(c)) return {};
    if (c != '_') digits += c;
  }
  return gap.found->text.front() == '_' ? digits : std::string();
}

}  // namespace

std::string hint(Gap const& gap) {
  if (std::string const digits = grouped_digits(gap); !digits.empty())
    return fmt::format("digits are not grouped: write `{}`", digits);
  if (gap.begins_with("parameter") && gap.statement.size() > 1 && words::contains(types, gap.statement[1].text) && gap.at == 2)
    return fmt::format("quantities have no types: remove `{}`", gap.statement[1].text);
  auto const found = std::find_if(situations.begin(), situations.end(), [&](Situation const& each) { return each.holds(gap); });
  return found == situations.end() ? std::string() : found->help;
}

}  // namespace sysid::grammar
