// A table of situations, first match wins.
#include "grammar/message/hints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/numeric/unit.hpp"
#include "grammar/message/explain.hpp"
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
/// `sd = 30 %`, up to the sign.
bool is_share_as_sd(Gap const& gap) {
  return found(gap, "%") && gap.at >= 3 && gap.before()->kind == TokenKind::number && gap.before(2)->is("=") &&
         gap.before(3)->is("sd");
}

constexpr std::array<Situation, 42> situations{{
    {[](Gap const& g) { return g.begins_with("parameter") && found(g, "~"); },
     "a parameter has a prior or a value: `parameter m [kg] ~ log_uniform(0.1, 10)`, `parameter m [kg] = 1`"},
    {[](Gap const& g) { return g.begins_with("parameter") && found(g, "in"); },
     "a prior is written `parameter name ~ uniform(lower, upper)`"},
    {[](Gap const& g) { return g.wanted.starts_with("a distribution") && g.begins_with("parameter"); },
     "a prior is a distribution with its arguments in parentheses: `~ log_uniform(lower, upper)`; a value is written with `=`"},
    {[](Gap const& g) { return g.wanted.starts_with("a distribution"); },
     "write the distribution of the data around the model: `~ normal(y, sd = sigma)`"},
    {[](Gap const& g) {
       return g.wanted == wanted::name && g.begins_with("model") && (found(g, "{") || found_kind(g, TokenKind::text));
     },
     "a model has a name: `model oscillator {`"},
    {[](Gap const& g) { return g.wanted == wanted::name && g.begins_with("model") && found(g, ")"); },
     "a model without arguments has no parentheses: `model oscillator {`"},
    {[](Gap const& g) { return g.wanted == "`experiment`"; }, "write `per experiment`: each data block is an experiment"},
    {[](Gap const& g) { return g.begins_with("split"); }, "rows are written `split train = rows 1..500`"},
    {[](Gap const& g) { return g.wanted == "a text in quotes" || (found(g, "'") && g.begins_with("file")); },
     "a text is written in double quotes on one line: `file \"measured.csv\"`"},
    {[](Gap const& g) {
       return g.begins_with("input") && g.wanted == wanted::end_of_statement && g.at > 3 && found_kind(g, TokenKind::word);
     },
     "the rule between samples is written after `hold`: `hold linear`"},
    {[](Gap const& g) { return found(g, "elseif") || found(g, "elif") || found(g, "elsif"); }, "write `else if`"},
    {[](Gap const& g) { return g.wanted == "`else`"; }, "every `if` needs an `else`: the value where the condition does not hold"},
    {[](Gap const& g) { return found(g, "if") && g.wanted != wanted::name && g.wanted != wanted::column; },
     "a value that depends on a condition is written `if condition then value else value`"},
    {[](Gap const& g) { return found(g, "[") && g.wanted == wanted::value; }, "a list is written in parentheses: `(1, 2)`"},
    {[](Gap const& g) { return found(g, ".") && (g.wanted == "`]`" || g.wanted == "']'"); },
     "units are multiplied with a space or `*`: `[N s/m]`"},
    {[](Gap const& g) { return (g.wanted == "`]`" || g.wanted == "']'") && found(g, ","); },
     "units are multiplied with a space or `*`: `[N s/m]`"},
    {[](Gap const& g) { return (g.wanted == "`]`" || g.wanted == "']'") && found(g, "-"); },
     "units are multiplied with a space or `*`, a power is written with `^`: `[N s/m]`, `[m s^-2]`"},
    {[](Gap const& g) {
       constexpr std::array<std::string_view, 5> operators{"+", "*", "/", "^", "-"};
       return g.wanted == wanted::value && g.found != nullptr && g.before() != nullptr &&
              words::contains(operators, g.found->text) && words::contains(operators, g.before()->text);
     },
     "two operators stand side by side: remove one, or write what belongs between them"},
    {[](Gap const& g) { return g.wanted == wanted::end_of_statement && (found(g, "prob") || found(g, "weight")) && g.at == 1; },
     "the prior probability of a candidate is written `NAME probability 0.5`"},
    {[](Gap const& g) { return g.wanted == wanted::item && found_kind(g, TokenKind::number); },
     "a name begins with a letter or `_`"},
    {[](Gap const& g) { return found(g, "=") && g.at == 0; },
     "an equation has two sides: `left = right`; one that goes on in the next line has `=` at the end of the line"},
    {[](Gap const& g) { return g.begins_with("parameter") && is_share_as_sd(g); },
     "a share of the mean is a product: of 30 % and a mean of 0.03, `sd = 0.3*0.03`"},
    {[](Gap const& g) { return g.begins_with("observe") && is_share_as_sd(g); },
     "a share of the signal is a product, and needs a floor: `sd = 0.05*abs(y) + sigma`"},
    {[](Gap const& g) { return found(g, "%") && g.before() != nullptr && g.before()->kind == TokenKind::number; },
     "a percentage is written `1 [percent]`"},
    {[](Gap const& g) {
       return (found(g, "%") && (g.at == 0 || g.wanted == wanted::end_of_statement)) || (found(g, "*") && g.at == 0);
     },
     "a comment begins with `#` or `//`"},
    {[](Gap const& g) { return found(g, "=") && g.before() != nullptr && g.before()->is("hold"); },
     "the rule follows `hold` without `=`: `hold linear`"},
    {[](Gap const& g) { return found(g, ")") && (g.wanted == wanted::equals || g.wanted == wanted::end_of_statement); },
     "no `(` is open here: remove the `)`, or open one before it"},
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
     "a model is fitted `to` data, a fit predicts `on` data: `fit MODEL to DATA`, `predict FIT on DATA`"},
    {[](Gap const& g) {
       return (g.wanted == wanted::with_or_end || g.wanted == wanted::preposition_or_end) && found_kind(g, TokenKind::word) &&
              words::contains(means_with, g.found->text);
     },
     "did you mean `with`?"},
    {[](Gap const& g) { return g.wanted == wanted::verb && g.found != nullptr && g.found->kind != TokenKind::word && g.at == 2; },
     "outside a block, `NAME =` begins a task; declare quantities inside a model: `constant g = 9.81 [m/s^2]`"},
    {[](Gap const& g) { return g.wanted == wanted::end_of_statement && found(g, ",") && g.begins_with("parameter"); },
     "declare each parameter in a statement of its own, without a start value: the fit chooses the start"},
    {[](Gap const& g) { return g.wanted == wanted::end_of_statement && found(g, ","); }, "begin a new line, or write `;`"},
    {[](Gap const& g) {
       bool const compares = g.find("<") < g.statement.size() || g.find(">") < g.statement.size();
       return g.wanted == wanted::equals && g.found == nullptr && compares;
     },
     "bounds are arguments of a prior: `parameter a ~ normal(0, sd = 1, lower = 0)`; an equation has two sides: `left = right`"},
    {[](Gap const& g) { return g.wanted == wanted::equals && g.found == nullptr; },
     "an equation has two sides: `left = right`; a definition is written `let name = value`"},
    {[](Gap const& g) { return g.wanted == wanted::opening_brace && g.begins_with("model"); },
     "a model is written `model name { ... }`; a name is made of letters, digits and `_`"},
    {[](Gap const& g) {
       return found(g, "(") && g.before() != nullptr && g.before(2) != nullptr && g.before(2)->is(".") && g.before()->is("diff");
     },
     "a derivative is written with primes: `y'`, `y''`"},
    {[](Gap const& g) {
       return !begins_with_verb(g) && g.before() != nullptr && g.before(2) != nullptr && g.before(2)->is(".") && found(g, "(");
     },
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

/// `fit m to d mh(samples = 100)`, `fit m to d, seed = 1`: options whose `with` is missing.
std::string options_without_with(Gap const& gap) {
  if (gap.found == nullptr || (gap.wanted != wanted::with_or_end && gap.wanted != wanted::preposition_or_end)) return {};
  bool const behind_comma =
      (gap.found->is("(") || gap.found->is("=")) && gap.before() != nullptr && gap.before(2) != nullptr && gap.before(2)->is(",");
  std::size_t const option = behind_comma ? gap.at - 1 : gap.at;
  if (gap.statement[option].kind != TokenKind::word || option + 1 >= gap.statement.size()) return {};
  Token const& next = gap.statement[option + 1];
  if (!next.is("(") && !next.is("=")) return {};
  return fmt::format("options follow `with`: write `with {}{}`{}", gap.statement[option].text, next.is("(") ? "(...)" : " = ...",
                     behind_comma ? " in place of the comma" : "");
}

/// Of whole digits only.
bool is_whole(std::string_view text) { return text.find_first_not_of("0123456789") == std::string_view::npos; }

/// `2,5`, `1,234.5`, `1.000,5`: the comma between two numbers that no blank holds apart.
std::string decimal_comma(Gap const& gap) {
  Token const* const left = gap.before();
  Token const* const right = gap.next();
  if (!found(gap, ",") || left == nullptr || right == nullptr || left->kind != TokenKind::number ||
      right->kind != TokenKind::number)
    return {};
  if (left->span.end != gap.found->span.begin || gap.found->span.end != right->span.begin) return {};
  std::size_t const point = right->text.find('.'), thousands = left->text.find('.');
  if (is_whole(left->text) && point == 3) return fmt::format("digits are not grouped: write `{}{}`", left->text, right->text);
  if (thousands != std::string_view::npos && left->text.size() == thousands + 4 && is_whole(right->text))
    return fmt::format("digits are not grouped, and a decimal point is `.`: write `{}{}.{}`", left->text.substr(0, thousands),
                       left->text.substr(thousands + 1), right->text);
  if (!is_whole(left->text) || !is_whole(right->text)) return {};
  std::string const decimal = fmt::format("write the number with a decimal point: `{}.{}`", left->text, right->text);
  return right->text.size() == 3 ? fmt::format("{}; digits are not grouped: `{}{}`", decimal, left->text, right->text) : decimal;
}

/// `observe "angle" [deg]`, `normal(phi, sd = [sigma])`: a name in quotes or in brackets.
std::string dressed_name(Gap const& gap) {
  if (gap.wanted == wanted::name && found_kind(gap, TokenKind::text) && gap.at == 1 && gap.found->text.size() > 2 &&
      (words::contains(words::model_statements, gap.statement[0].text) ||
       words::contains(words::data_statements, gap.statement[0].text)))
    return fmt::format("write the name without quotes: `{} {}`", gap.statement[0].text,
                       gap.found->text.substr(1, gap.found->text.size() - 2));
  bool const argument = gap.wanted == "an argument" && gap.next(4) != nullptr && gap.next()->is("=") && gap.next(2)->is("[");
  if (argument && gap.next(3)->kind != TokenKind::symbol && gap.next(4)->is("]"))
    return fmt::format("write it without brackets: `{} = {}`", gap.found->text, gap.next(3)->text);
  return {};
}

/// What lacks one sign: the statement with it.
std::string repaired_statement(Gap const& gap) {
  Token const* const before = gap.before();
  if (gap.found == nullptr || before == nullptr) return {};
  std::string_view const so_far = written(gap.statement[0], *before);
  bool const binds = std::any_of(gap.statement.begin(), gap.statement.begin() + static_cast<std::ptrdiff_t>(gap.at),
                                 [](Token const& each) { return each.is("=") || each.is("~"); });
  bool const list = gap.begins_with("state") || gap.begins_with("input") || gap.begins_with("shared");
  if (gap.wanted == wanted::end_of_statement && list && !binds && gap.found->kind == TokenKind::word && !gap.found->is("hold") &&
      (before->is("]") || gap.begins_with("shared")))
    return fmt::format("separate the names by commas: `{}, {}`", so_far, gap.found->text);
  bool const declared = gap.begins_with("parameter") || gap.begins_with("constant");
  if (declared && !binds && gap.found->kind == TokenKind::number && before->kind != TokenKind::number &&
      (gap.wanted == wanted::end_of_statement || gap.wanted == wanted::equals))
    return fmt::format("a value is written with `=`: `{} = {}`", so_far, gap.found->text);
  bool const bound = gap.begins_with("measure") || gap.begins_with("input");
  if (bound && gap.wanted == wanted::equals && gap.statement.size() > 1 && gap.at == 2)
    return fmt::format("the column comes after `=`: `{} NAME = {}`", gap.statement[0].text, before->text);
  bool const settings = gap.begins_with("exclude") || gap.begins_with("terms") || gap.begins_with("target");
  if (settings && gap.wanted == wanted::equals) return fmt::format("write `{} = {}`", so_far, gap.found->text);
  // `y (mm)` of a column or a declared name.
  if (gap.found->is("(") && gap.wanted == wanted::end_of_statement && gap.at + 1 < gap.statement.size()) {
    std::size_t const end = end_of_unit(gap.statement, gap.at + 1);
    if (end > gap.at + 1 && end < gap.statement.size() && gap.statement[end].is(")"))
      return fmt::format("a unit is written in brackets: `{} [{}]`", before->text,
                         written(gap.statement[gap.at + 1], gap.statement[end - 1]));
  }
  return {};
}

/// `[m/s^2]` of `9.81 m/s^2/L` in an equation: up to the last word that the file does not declare, or that is a second below a
/// fraction line, though a noise is often named so. Empty where all words are declared.
std::string unit_of_no_names(Gap const& gap) {
  std::size_t const most = end_of_unit(gap.statement, gap.at);
  std::size_t end = gap.at;
  bool all_declared = true;
  for (std::size_t i = gap.at; i < most; ++i) {
    if (gap.statement[i].kind != TokenKind::word) continue;
    bool const declared = gap.declares(gap.statement[i].text);
    bool const second = gap.statement[i].is("s") && i > gap.at && gap.statement[i - 1].is("/");
    all_declared = all_declared && declared;
    if (declared && !second) continue;
    end = i + 1;
    if (end + 1 < most && gap.statement[end].is("^")) end += 2;
  }
  return all_declared ? std::string() : fmt::format("[{}]", gap.text(gap.at, end));
}

}  // namespace

std::string_view written(Token const& first, Token const& last) {
  return {first.text.data(), static_cast<std::size_t>(last.text.data() + last.text.size() - first.text.data())};
}

std::size_t end_of_unit(std::span<Token const> statement, std::size_t from) {
  std::size_t end = from;
  bool factor = true;  // one may come next
  for (std::size_t i = from; i < statement.size(); ++i) {
    Token const& token = statement[i];
    bool const power = i > from && statement[i - 1].is("^");
    if (token.kind == TokenKind::word && !power && unit_atom(token.text)) {
      if (i + 1 < statement.size() && statement[i + 1].is("(")) break;
      end = i + 1;
      factor = false;
    } else if (token.kind == TokenKind::number && power) {
      end = i + 1;
    } else if (factor || !(token.is("/") || token.is("*") || token.is("^"))) {
      break;
    } else {
      factor = !token.is("^");
    }
  }
  return end;
}

std::size_t Gap::find(std::string_view symbol, std::size_t from) const {
  while (from < statement.size() && !statement[from].is(symbol)) ++from;
  return std::min(from, statement.size());
}

std::string_view Gap::text(std::size_t from, std::size_t end) const {
  return from < std::min(end, statement.size()) ? written(statement[from], statement[std::min(end, statement.size()) - 1])
                                                : std::string_view();
}

std::size_t Gap::closing(std::size_t opener) const {
  int depth = 0;
  for (std::size_t i = opener; i < statement.size(); ++i) {
    depth += statement[i].is("(") || statement[i].is("[") ? 1 : statement[i].is(")") || statement[i].is("]") ? -1 : 0;
    if (depth == 0) return i;
  }
  return statement.size();
}

std::string unit_without_brackets(Gap const& gap) {
  if (!found_kind(gap, TokenKind::word) || gap.before() == nullptr || gap.before()->kind == TokenKind::symbol) return {};
  // `t in s`: the word is no inch where a unit follows it.
  std::size_t const behind = found(gap, "in") ? end_of_unit(gap.statement, gap.at + 1) : gap.at;
  if (behind > gap.at + 1 && !(behind < gap.statement.size() && gap.statement[behind].is("..")))
    return fmt::format("[{}]", gap.text(gap.at + 1, behind));
  if (found(gap, "in") && gap.begins_with("parameter")) return {};  // of a range
  std::size_t const end = end_of_unit(gap.statement, gap.at);
  if (end == gap.at) return {};
  return fmt::format("[{}]", written(*gap.found, gap.statement[end - 1]));
}

std::string instead_of_product(Gap const& gap) {
  Token const* const left = gap.before();
  if (left == nullptr || gap.found == nullptr) return {};
  int depth = 0;
  for (std::size_t i = 0; i < gap.at; ++i) depth += gap.statement[i].is("(") ? 1 : gap.statement[i].is(")") ? -1 : 0;
  bool const begins_argument = gap.before(2) != nullptr && (gap.before(2)->is("(") || gap.before(2)->is(","));
  if (left->kind == TokenKind::number && gap.found->kind == TokenKind::number) {
    std::string const comma = fmt::format("arguments are separated by commas: `{}, {}`", left->text, gap.found->text);
    std::string const grouped = gap.found->text.size() == 3 && gap.found->text.find_first_not_of("0123456789") == std::string::npos
                                    ? fmt::format("digits are not grouped: write `{}{}`", left->text, gap.found->text)
                                    : std::string();
    return depth == 0 ? grouped : grouped.empty() ? comma : comma + "; " + grouped;
  }
  bool const imaginary = left->kind == TokenKind::number && left->span.end == gap.found->span.begin &&
                         (gap.found->is("i") || gap.found->is("j")) && !gap.declares(gap.found->text);
  if (imaginary) return "there are no complex numbers: write an equation for the real and one for the imaginary part";
  // In an equation a number stands before a name more often than before a unit.
  bool const declaration = words::contains(words::model_statements, gap.statement[0].text) ||
                           words::contains(words::data_statements, gap.statement[0].text) || begins_with_verb(gap);
  if (left->kind == TokenKind::number)
    if (std::string const unit = declaration ? unit_without_brackets(gap) : unit_of_no_names(gap); !unit.empty())
      return fmt::format("a unit is written in brackets: `{} {}`", left->text, unit);
  Token const* const next = gap.next();
  if (left->kind == TokenKind::number && gap.found->is("to") && next != nullptr && next->kind == TokenKind::number)
    return fmt::format("a range is written `{}..{}`", left->text, next->text);
  if (left->kind == TokenKind::word && depth > 0 && begins_argument && gap.found->is("in") && next != nullptr) {
    std::size_t end = gap.at + 1;
    while (end < gap.statement.size() && !gap.statement[end].is(",") && !gap.statement[end].is(")")) ++end;
    if (end > gap.at + 1) return fmt::format("a named argument is written `{} = {}`", left->text, gap.text(gap.at + 1, end));
  }
  if (left->kind == TokenKind::word && depth > 0 && begins_argument && gap.found->kind != TokenKind::symbol)
    return fmt::format("a named argument is written `{} = {}`", left->text, gap.found->text);
  // An option of a task stands behind `with` or a comma.
  bool const option = gap.before(2) != nullptr && (gap.before(2)->is(",") || gap.before(2)->is("with"));
  if (left->kind == TokenKind::word && begins_with_verb(gap) && option && gap.found->kind == TokenKind::number)
    return fmt::format("an option is written `{} = {}`", left->text, gap.found->text);
  return {};
}

namespace {

/// `20.5*[N s/m]`: the number with its unit.
std::string unit_as_factor(Gap const& gap) {
  bool const factor = gap.wanted == wanted::value && gap.found_is("[") && gap.before() != nullptr && gap.before()->is("*");
  if (!factor || gap.before(2) == nullptr || gap.before(2)->kind != TokenKind::number) return {};
  std::size_t const close = gap.closing(gap.at);
  if (close >= gap.statement.size()) return {};
  return fmt::format("a unit follows its number without `*`: write `{} {}`", gap.before(2)->text, gap.text(gap.at, close + 1));
}

}  // namespace

std::string hint(Gap const& gap) {
  if (std::string unit = unit_as_factor(gap); !unit.empty()) return unit;
  if (std::string here = hint_in_model(gap); !here.empty()) return here;
  if (std::string here = hint_in_block(gap); !here.empty()) return here;
  if (std::string options = options_without_with(gap); !options.empty()) return options;
  if (std::string point = decimal_comma(gap); !point.empty()) return point;
  if (std::string repaired = repaired_statement(gap); !repaired.empty()) return repaired;
  if (gap.wanted == wanted::end_of_statement && gap.before() != nullptr)
    if (std::string const unit = unit_without_brackets(gap); !unit.empty())
      return fmt::format("a unit is written in brackets: `{} {}`", gap.before()->text, unit);
  if (std::string name = dressed_name(gap); !name.empty()) return name;
  if (std::string const digits = grouped_digits(gap); !digits.empty())
    return fmt::format("digits are not grouped: write `{}`", digits);
  if (gap.begins_with("parameter") && gap.statement.size() > 1 && words::contains(types, gap.statement[1].text) && gap.at == 2)
    return fmt::format("quantities have no types: remove `{}`", gap.statement[1].text);
  auto const found = std::find_if(situations.begin(), situations.end(), [&](Situation const& each) { return each.holds(gap); });
  return found == situations.end() ? std::string() : found->help;
}

}  // namespace sysid::grammar
