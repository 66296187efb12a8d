// What stands behind a prior, a declared name or a definition and does not belong there; products, signs and words of paper.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/numeric/unit.hpp"
#include "grammar/message/explain.hpp"
#include "grammar/message/hints.hpp"
#include "syntax/foreign_words.hpp"
#include "syntax/words.hpp"

namespace sysid::grammar {

namespace {

constexpr std::array<std::string_view, 13> truncations{"T",       "I",           "trunc",  "truncated", "truncate",
                                                       "bounded", "bounds",      "limits", "limited",   "restricted",
                                                       "between", "constrained", "clipped"};
constexpr std::array<std::string_view, 8> start_words{"start", "init", "initial", "initially", "at", "from", "guess", "value"};
constexpr std::array<std::string_view, 3> definitions{"let", "derive", "constant"};

std::string no_start(std::string_view rest) {
  bool bounds = words::contains(truncations, rest.substr(0, rest.find(' ')));
  for (std::string_view const bound : {"lower", "upper", "min", "max", "bounds"}) bounds = bounds || rest.find(bound) < 3;
  if (bounds) return "bounds are arguments of the prior: `normal(0, sd = 1, lower = 0, upper = 1)`";
  return fmt::format("remove `{}`: a parameter has no start value, the search begins at draws of the prior", rest);
}

bool is_task(Gap const& gap) {
  return words::contains(words::verbs, gap.statement[0].text) ||
         (gap.statement.size() > 2 && gap.statement[1].is("=") && words::contains(words::verbs, gap.statement[2].text));
}

/// The words of a unit, with or without quotes around them, as it is written; empty where they are none.
std::string bracketed_unit(Gap const& gap, std::size_t from, std::size_t end) {
  if (from >= end) return {};
  if (gap.statement[from].kind == TokenKind::text) {
    std::string_view const quoted = gap.statement[from].text;
    return quoted.size() > 2 ? fmt::format("[{}]", quoted.substr(1, quoted.size() - 2)) : std::string();
  }
  return end_of_unit(gap.statement, from) == end ? fmt::format("[{}]", gap.text(from, end)) : std::string();
}

std::size_t first_comma(Gap const& gap, std::size_t opener) { return comma_from(gap, opener + 1, gap.closing(opener)); }

/// `normal(20, sd = 5)T(0, 100)`: the prior with its bounds inside.
std::string truncation(Gap const& gap, std::size_t tilde) {
  if (!gap.found_word() || gap.next() == nullptr || !(gap.next()->is("(") || gap.next()->is("["))) return {};
  if (!words::contains(truncations, gap.found->text)) return {};
  std::size_t const opener = gap.at + 1, close = gap.closing(opener), comma = first_comma(gap, opener);
  if (gap.statement[tilde + 1].is("uniform") || gap.statement[tilde + 1].is("log_uniform"))
    return fmt::format("remove `{}`: the arguments of `{}` are its bounds", gap.rest(), gap.statement[tilde + 1].text);
  std::string_view const lower = gap.text(opener + 1, std::min(comma, close)),
                         upper = comma < close ? gap.text(comma + 1, close) : std::string_view();
  return fmt::format("bounds are arguments of the prior: `{}{}{}{}{})`", gap.text(tilde + 1, gap.at - 1),
                     lower.empty() ? "" : ", lower = ", lower, upper.empty() ? "" : ", upper = ", upper);
}

/// Behind the distribution of a prior or of a channel.
std::string behind_distribution(Gap const& gap) {
  std::size_t const tilde = gap.find("~");
  bool const parameter = gap.begins_with("parameter"), disturbance = gap.begins_with("disturbance");
  if (gap.wanted != wanted::end_of_statement || gap.found == nullptr || tilde + 2 >= gap.at || tilde < 2) return {};
  if (!parameter && !disturbance && !gap.begins_with("observe")) return {};
  std::string_view const head = gap.text(0, tilde), prior = gap.text(tilde + 1, gap.at);
  std::size_t const unit = gap.find("[");
  if (gap.found->is("[") && gap.closing(gap.at) < gap.statement.size()) {
    std::string_view const written_unit = gap.text(gap.at, gap.closing(gap.at) + 1);
    return unit < tilde ? fmt::format("remove `{}`: numbers here are in the unit of `{}`", written_unit, gap.statement[1].text)
                        : fmt::format("the unit comes after the name: `{} {} ~ {}`", head, written_unit, prior);
  }
  if (parameter && gap.found->is("per")) {
    std::size_t const name_end = std::min(unit, tilde);
    return fmt::format("`per experiment` comes after the name: `{} per experiment{}{} ~ {}`", gap.text(0, name_end),
                       name_end < tilde ? " " : "", gap.text(name_end, tilde), prior);
  }
  std::size_t const comma = first_comma(gap, tilde + 2);
  if (gap.begins_with("observe") && (gap.found->is("+") || gap.found->is("-")) && comma < gap.at && gap.statement[comma].is(","))
    return fmt::format("what is measured stands inside: `{} {}{}`", gap.text(tilde + 1, comma), gap.rest(),
                       gap.text(comma, gap.at));
  if (!parameter) return fmt::format("remove `{}`", gap.rest());
  if (std::string bounds = truncation(gap, tilde); !bounds.empty()) return bounds;
  if (gap.found->is("=")) return fmt::format("a parameter has a prior or a value: remove `{}`", gap.rest());
  if (gap.found->is(",") && gap.next() != nullptr && gap.next()->newline_before) return "remove the comma";
  bool const another = gap.found->is(",") && gap.next(2) != nullptr && gap.next()->kind == TokenKind::word &&
                       (gap.next(2)->is("~") || gap.next(2)->is("["));
  if (another)
    return fmt::format("declare each parameter in a statement of its own: `parameter {}`",
                       gap.text(gap.at + 1, gap.statement.size()));
  Token const* const sign = gap.next(2);
  bool const bound = gap.found->is(",") && sign != nullptr && (sign->is("<") || sign->is(">") || sign->is("<=") || sign->is(">="));
  if (bound && gap.next(3) != nullptr)
    return fmt::format("bounds are arguments of the prior: `{}, {} = {})`", gap.text(tilde + 1, gap.at - 1),
                       sign->text.front() == '>' ? "lower" : "upper", gap.text(gap.at + 3, gap.statement.size()));
  return gap.found->is(",") || gap.found_word() ? no_start(gap.rest()) : std::string();
}

/// `~ 10^uniform(-3, 0)`.
std::string power_of_uniform(Gap const& gap) {
  bool const ten = gap.wanted.starts_with("a distribution") && gap.found_is("10") && gap.next(3) != nullptr;
  if (!ten || !gap.next()->is("^") || !gap.next(2)->is("uniform") || !gap.next(3)->is("(")) return {};
  std::size_t const opener = gap.at + 3, close = gap.closing(opener), comma = first_comma(gap, opener);
  if (comma >= close || close >= gap.statement.size()) return {};
  auto const power = [&](std::size_t from, std::size_t end) {
    return fmt::format(fmt::runtime(end - from > 2 ? "10^({})" : "10^{}"), gap.text(from, end));
  };
  return fmt::format("write `log_uniform({}, {})`", power(opener + 1, comma), power(comma + 1, close));
}

/// `~ pm.Normal(0, 1)`, `~ flat`: a distribution with a module before it, or without parentheses.
std::string at_distribution(Gap const& gap) {
  if (gap.wanted == wanted::tilde && gap.begins_with("observe") && gap.found == nullptr && gap.at >= 2)
    return fmt::format("write the distribution of the data around the model: `{} ~ normal(y, sd = sigma)`", gap.text(0, gap.at));
  if (gap.wanted == wanted::tilde && gap.begins_with("observe") && gap.at >= 2 && (gap.found_is(",") || gap.found_is("and")))
    return fmt::format("each channel has an `observe` of its own: `{} ~ normal(y, sd = sigma)`", gap.text(0, gap.at));
  if (std::string whole = power_of_uniform(gap); !whole.empty()) return whole;
  if (!gap.wanted.starts_with("a distribution") || !gap.found_word()) return {};
  if (gap.next() != nullptr && gap.next()->is(".")) return distribution_of_module(gap);
  return gap.next() == nullptr && gap.found->is("flat") ? "write `flat()`" : "";
}

/// The name that was declared last before the gap, without what follows it.
std::string_view declared_name(Gap const& gap) {
  std::size_t name = 1;
  for (std::size_t i = 1; i < gap.at; ++i)
    if (gap.statement[i].is(",")) name = i + 1;
  return name < gap.statement.size() ? gap.statement[name].text : std::string_view();
}

/// The number among the tokens from the gap on: of `start 0`, `(start = 0)`, `= -1`.
std::string number_in_rest(Gap const& gap) {
  for (std::size_t i = gap.at; i < gap.statement.size(); ++i)
    if (gap.statement[i].kind == TokenKind::number)
      return fmt::format("{}{}", gap.statement[i - 1].is("-") ? "-" : "", gap.statement[i].text);
  return {};
}

/// Behind a declared name, before a `=` or a `~`.
std::string behind_declared(Gap const& gap) {
  bool const state = gap.begins_with("state"), input = gap.begins_with("input"), parameter = gap.begins_with("parameter");
  bool const at_end = gap.wanted == wanted::end_of_statement;
  if (gap.found == nullptr || !at_end || !(state || input || parameter) || gap.at < 2) return {};
  if (gap.find("=") < gap.at || gap.find("~") < gap.at) return {};
  std::string_view const name = declared_name(gap), rest = gap.rest();
  std::string const number = number_in_rest(gap);
  if (state && gap.found->is("initial") && gap.next() != nullptr) return "begin a new line before `initial`, or write `;`";
  bool const starts = gap.found->is("=") || gap.found->is("(") || words::contains(start_words, gap.found->text);
  if (state && starts && !number.empty())
    return fmt::format("an initial value is a statement of its own: remove `{}` and write `initial {} = {}`", rest, name, number);
  if (state && gap.found->is("="))
    return fmt::format(
        "the measurement of a state is declared with `observe`: remove `{}` and write `observe {} ~ normal({}, sd = 1)`", rest,
        gap.next() == nullptr ? "channel" : gap.next()->text, name);
  if (state && gap.found->is("~"))
    return fmt::format(
        "a random initial value is a statement of its own: remove `{0}` and write `initial {1} ~ normal(0, sd = 1)`; "
        "one that is to be estimated is a parameter: `parameter {1}0 ~ ...` and `initial {1} = {1}0`",
        rest, name);
  if (input && gap.found->is("="))
    return fmt::format("the column of an input is written in the data block: remove `{}` here", rest);
  if (input && gap.found->is("hold"))
    return fmt::format("the rule between samples is written in the data block: remove `{}` here", rest);
  if ((state || input) && gap.found_word() && gap.found->text.ends_with('\'')) {
    std::string_view const bare = gap.found->text.substr(0, gap.found->text.find('\''));
    std::size_t const end = std::min(gap.find(",", gap.at), gap.statement.size());
    return gap.at == 1
               ? fmt::format("declare it without primes: `{} {}`", gap.statement[0].text, bare)
               : fmt::format("derivatives are not declared, they follow from `{}`: remove `{}`", bare, gap.text(gap.at - 1, end));
  }
  if (gap.found->is("in") && gap.next() != nullptr && gap.next()->is("[")) return "remove `in`";
  if (parameter && gap.found->is("per") && gap.before()->is("]"))
    return fmt::format("`per experiment` comes before the unit: `{} per experiment {}`", gap.text(0, gap.find("[")),
                       gap.text(gap.find("["), gap.at));
  if (gap.found->is("<")) {
    std::size_t const end = gap.find(">", gap.at);
    if (std::string const unit = bracketed_unit(gap, gap.at + 1, end); !unit.empty() && end < gap.statement.size())
      return fmt::format("a unit is written in brackets: `{} {}`", name, unit);
    if (parameter && end < gap.statement.size())
      return fmt::format("bounds are arguments of the prior, `normal(0, sd = 1, lower = 0)`: remove `{}`",
                         gap.text(gap.statement[1].is("real") ? 1 : gap.at, end + 1));
  }
  bool const bound = gap.found->is(">") || gap.found->is("<") || gap.found->is(">=") || gap.found->is("<=");
  if (parameter && bound && gap.find("~") < gap.statement.size() && gap.statement.back().is(")")) {
    // Behind the number the unit of the parameter, unless it has one before.
    std::size_t const tilde = gap.find("~"), end = gap.find("[") < gap.at ? tilde : std::min(gap.find("[", gap.at), tilde);
    return fmt::format("bounds are arguments of the prior: `{} {}, {} = {})`", gap.text(0, gap.at),
                       gap.text(end, gap.statement.size() - 1), gap.found->text.front() == '>' ? "lower" : "upper",
                       gap.text(gap.at + 1, end));
  }
  if (parameter && bound)
    return fmt::format("bounds are arguments of a prior: `{} ~ normal(0, sd = 1, {} = {})`", gap.text(0, gap.at),
                       gap.found->text.front() == '>' ? "lower" : "upper", gap.text(gap.at + 1, gap.statement.size()));
  if (gap.found->kind == TokenKind::text)
    return fmt::format("a unit is written in brackets: `{} {}`", name, bracketed_unit(gap, gap.at, gap.at + 1));
  if (gap.found->is("'")) {
    std::string_view quoted = gap.text(gap.at + 1, std::min(gap.find("~"), gap.find("=")));
    if (quoted.ends_with('\'')) quoted.remove_suffix(1);
    return fmt::format("a unit is written in brackets: `{} [{}]`", name, quoted);
  }
  return {};
}

/// `[m^1/2]`, `phi[2]`, `[1000 kg]`.
std::string number_in_unit(Gap const& gap) {
  Token const *line = gap.before(), *above = gap.before(2), *sign = gap.before(3);
  if (line == nullptr) return {};
  if (line->is("/") && sign != nullptr && sign->is("^"))
    return fmt::format("a fraction as a power has parentheses: `[{}({}/{})]`", gap.text(gap.find("[") + 1, gap.at - 2), above->text,
                       gap.found->text);
  bool const alone = line->is("[") && gap.next() != nullptr && gap.next()->is("]");
  bool const behind_name = gap.at == 3 && words::contains(words::model_statements, gap.statement[0].text);
  if (alone && behind_name && !gap.found->is("0") && gap.found->text.find_first_of(".eE") == std::string_view::npos)
    return fmt::format("a size is written in parentheses: `{}({})`; a pure number has the unit `[-]`", gap.statement[1].text,
                       gap.found->text);
  return alone ? "a pure number has the unit `[-]`" : "a unit has a prefix in place of a number: `[mm]`, `[kN]`";
}

/// Inside the brackets of a unit.
std::string in_unit(Gap const& gap) {
  if (gap.wanted != "a unit" || gap.found == nullptr) return {};
  if (gap.found->kind == TokenKind::text)
    return fmt::format("a unit is written without quotes: `{}`", bracketed_unit(gap, gap.at, gap.at + 1));
  if (gap.found->kind == TokenKind::number) return number_in_unit(gap);
  if (gap.found->is("]")) return "write the unit in the brackets, `[N s/m]`, or `[-]` for a pure number";
  if (gap.found->is("[")) return "write one pair of brackets";
  return {};
}

/// `fn = sqrt(k/m) [Hz]`, `derive [Hz] fn`, `spring [N] = k*y`, `q[n] [m]`: a unit, or a size, in another place.
std::string at_bracket(Gap const& gap) {
  if (!gap.found_is("[") || gap.closing(gap.at) >= gap.statement.size() || gap.wanted.starts_with("a ")) return {};
  std::size_t const close = gap.closing(gap.at), equals = gap.find("=");
  std::string_view const unit = gap.text(gap.at, close + 1);
  bool const definition = words::contains(definitions, gap.statement[0].text), parameter = gap.begins_with("parameter");
  bool const keyword = words::contains(words::model_statements, gap.statement[0].text);
  if (gap.at == 1 && keyword && close + 1 < gap.statement.size())
    return fmt::format("the unit comes after the name: `{} {} {}`", gap.statement[0].text, gap.statement[close + 1].text, unit);
  if (gap.at == 1 && !keyword && equals == close + 1 && equals < gap.statement.size())
    return fmt::format("a definition begins with `let`: `let {}`", gap.text(0, gap.statement.size()));
  if (gap.at == 1 && !keyword && close + 1 == gap.statement.size())
    return fmt::format("a declaration begins with its keyword: `state {0}`, `parameter {0} ~ ...`, `let {0} = ...`",
                       gap.text(0, close + 1));
  if (close == gap.at + 2 && gap.next()->kind == TokenKind::number && gap.before()->kind == TokenKind::word)
    return fmt::format("an element of a vector is written without a blank: `{}{}`", gap.before()->text, unit);
  if ((definition || parameter) && equals < gap.at)
    return gap.find("[") < equals ? fmt::format("remove `{}`: the value has the unit of `{}`", unit, gap.statement[1].text)
                                  : fmt::format("the unit comes after the name: `{} {} = {}`", gap.text(0, equals), unit,
                                                gap.text(equals + 1, gap.at));
  bool const declares = keyword && gap.wanted == wanted::end_of_statement && gap.at >= 2;
  if (declares && gap.before()->is("]") && gap.at >= 4)
    return fmt::format("the size of a vector is written in parentheses: `{}({})`", declared_name(gap),
                       gap.text(gap.find("[") + 1, gap.at - 1));
  bool const other = is_task(gap) || words::contains(words::data_statements, gap.statement[0].text);
  constexpr std::array<std::string_view, 5> operators{"+", "-", "*", "/", "^"};
  bool const operand = close + 1 < gap.statement.size() && words::contains(operators, gap.statement[close + 1].text);
  bool const value = gap.wanted == "')'" || (!keyword && (operand || (gap.wanted == wanted::end_of_statement && equals < gap.at)));
  if (value && !other && gap.before()->kind == TokenKind::word)
    return fmt::format("remove `{}`: `{}` has the unit that it is declared with", unit, gap.before()->text);
  return {};
}

/// Behind `let name`, where `=` is missing.
std::string in_definition(Gap const& gap) {
  if (!words::contains(definitions, gap.statement[0].text) || gap.found == nullptr) return {};
  if (gap.wanted == wanted::name && gap.found->kind == TokenKind::number) return "a name begins with a letter or `_`";
  if (gap.wanted != wanted::equals || gap.at < 2) return {};
  bool const one = gap.found_word() && gap.next() != nullptr && (gap.next()->is("=") || gap.next()->is("["));
  bool const other = gap.found->is("-") && gap.next(2) != nullptr && gap.next()->kind == TokenKind::word && gap.next(2)->is("=");
  if (one || other) return fmt::format("a name is one word: `{}_{}`", gap.before()->text, one ? gap.found->text : gap.next()->text);
  if (gap.found_word() || gap.found->kind == TokenKind::number)
    return fmt::format("write `{} = {}`", gap.text(0, gap.at), gap.rest());
  return {};
}

std::string in_initial(Gap const& gap) {
  if (!gap.begins_with("initial") || gap.found == nullptr) return {};
  if (std::size_t const both = gap.find("and"); gap.found->is("=") && both < gap.at)
    return fmt::format("separate initial values by commas: `{}, {}`", gap.text(0, both), gap.text(both + 1, gap.statement.size()));
  if (gap.wanted.starts_with("a distribution") && gap.before() != nullptr && gap.before()->is("~"))
    return fmt::format("a random initial value is written `{} normal(0, sd = 1)`, a known one with `=`", gap.text(0, gap.at));
  if (gap.wanted == wanted::name && gap.found->kind == TokenKind::number)
    return "an initial value names its state: `initial y = 0`";
  bool const names_first = gap.wanted == wanted::equals && gap.found->is(",");             // `y, y' = 0, 0`
  bool const values_first = gap.wanted == wanted::end_of_statement && gap.found->is("=");  // `y = y' = 0`
  if (names_first || values_first) return "each initial value has a state of its own: `initial y = 0, y' = 0`";
  return {};
}

/// `disturbance w [N] = ...`, `disturbance w, v ~ ...`, `disturbance w [N]`, `disturbance w ~ white`.
std::string in_disturbance(Gap const& gap) {
  if (!gap.begins_with("disturbance") || gap.at < 2) return {};
  std::string_view const head = gap.text(0, std::min({gap.at, gap.find("~"), gap.find(",")}));
  std::string const law = fmt::format("`{} ~ white(intensity = 1)`, in discrete time `~ normal(0, sd = 1)`", head);
  if (gap.wanted.starts_with("a distribution"))
    return fmt::format("a disturbance needs a law (its distribution) with arguments: {}", law);
  if (gap.wanted != wanted::tilde) return {};
  if (gap.found == nullptr) return fmt::format("write its law: {}", law);
  if (gap.found->is(","))
    return fmt::format(
        "declare each disturbance in a statement of its own: {}; several with the same law can be a vector, `disturbance {}(2) ~ "
        "...`",
        law, gap.statement[1].text);
  if (gap.found->is("="))
    return fmt::format("declare a known quantity with `let` or as an input; a disturbance has a law in place of `{}`: {}",
                       gap.rest(), law);
  return {};
}

/// `d^2y/dt^2`, `d^2(y)/dt^2`, `d/dt y`, at the `y`.
std::string differential_quotient(Gap const& gap) {
  Token const *last = gap.before(), *sign = gap.before(2), *letter = gap.before(3);
  if (letter == nullptr || !letter->is("d") || gap.declares("d")) return {};
  bool const behind = last->is("dt") && sign->is("/"), above = (last->is("2") || last->is("3")) && sign->is("^");
  bool const inside = gap.found_is("(") && gap.next() != nullptr;
  Token const& of = inside ? *gap.next() : *gap.found;
  std::size_t const end = inside ? gap.closing(gap.at) + 1 : gap.at + 1;
  bool const over_time = above && end + 1 < gap.statement.size() && gap.statement[end].is("/") && gap.statement[end + 1].is("dt");
  if (!(behind || over_time)) return {};
  if (inside && end != gap.at + 3)
    return "primes stand behind one name: write out the derivative of what is in the parentheses, with `y'` or `y''` for that of "
           "`y`";
  if (of.kind != TokenKind::word) return {};
  return fmt::format("a derivative is written with primes: write `{}{}` in place of the quotient", of.text,
                     std::string(behind          ? 1
                                 : last->is("3") ? 3
                                                 : 2,
                                 '\''));
}

/// A text in quotes that describes what stands before it; behind a declared name it may be its unit.
std::string description(Gap const& gap) {
  if (gap.found == nullptr || gap.found->kind != TokenKind::text || gap.at < 2 || gap.found->text.size() < 3) return {};
  std::string_view const quoted = gap.found->text.substr(1, gap.found->text.size() - 2);
  bool const declaration = words::contains(words::model_statements, gap.statement[0].text);
  bool const ends = gap.wanted == wanted::operator_between || (gap.wanted == wanted::end_of_statement && declaration);
  bool const binds = gap.find("=") < gap.at || gap.find("~") < gap.at;
  bool const unit = !binds && gap.before()->kind == TokenKind::word && unit_atom(quoted.substr(0, quoted.find_first_of(" /*^")));
  if (!ends || unit || is_task(gap) || gap.before()->text == "\"\"") return {};
  return fmt::format("a description is a comment, which begins with `#`: `# {}`", quoted);
}

/// `parameters { ... }` inside a model.
std::string inner_block(Gap const& gap) {
  bool const block = gap.found_is("{") && gap.at == 1 && gap.statement[0].kind == TokenKind::word;
  return block ? instead_of_inner_block(gap.statement[0].text) : std::string();
}

/// `k = pm.Uniform("k", lower=1, upper=10)`, `vector[3] k`, a text in three quotes, `sin^2(y)`.
std::string of_other_language(Gap const& gap) {
  Token const *left = gap.before(), *right = gap.found;
  if (right == nullptr || left == nullptr || gap.wanted != wanted::operator_between) return {};
  bool const module = gap.at == 5 && right->is("(") && gap.statement[1].is("=") && gap.statement[3].is(".");
  Token const* const comma = gap.next(2);
  if (module && comma != nullptr && gap.next()->kind == TokenKind::text && comma->is(",") &&
      gap.closing(gap.at) < gap.statement.size())
    return fmt::format("a parameter has its prior in one statement: `parameter {} ~ {}`", gap.statement[0].text,
                       call_of_module(gap, gap.at));
  constexpr std::array<std::string_view, 5> vectors{"vector", "array", "real", "row_vector", "int"};
  if (left->is("]") && gap.found_word() && words::contains(vectors, gap.statement[0].text) && gap.at > 3)
    return fmt::format("a vector is declared with its size: `parameter {0}({1}) ~ ...`, `state {0}({1})`", right->text,
                       gap.text(2, gap.at - 1));
  if (left->kind == TokenKind::text && left->text == "\"\"" && right->kind == TokenKind::text)
    return "a comment begins with `#` or `//`";
  Token const *power = gap.before(2), *function = gap.before(3);
  if (std::string quotient = differential_quotient(gap); !quotient.empty()) return quotient;
  bool const raised = right->is("(") && left->kind == TokenKind::number && power != nullptr && power->is("^") &&
                      function != nullptr && function->kind == TokenKind::word && !gap.declares(function->text);
  if (raised && gap.closing(gap.at) < gap.statement.size())
    return fmt::format("the power of a function comes after its argument: `{}{}^{}`", function->text,
                       gap.text(gap.at, gap.closing(gap.at) + 1), left->text);
  return {};
}

/// Values side by side, signs and points of paper.
std::string in_expression(Gap const& gap) {
  Token const *left = gap.before(), *right = gap.found;
  if (right == nullptr || left == nullptr) return {};
  bool const number = left->kind == TokenKind::number;
  bool const side_by_side = gap.wanted == wanted::operator_between;
  if (side_by_side && number && (right->is("pi") || right->is("π")))
    return gap.before(2) != nullptr && gap.before(2)->is("/")
               ? fmt::format("a product in a denominator needs parentheses: `/({}*pi)`", left->text)
               : fmt::format("multiplication is written with `*`: `{}*pi`", left->text);
  if (side_by_side && number && right->is("x") && gap.next(2) != nullptr && gap.next()->is("10") && gap.next(2)->is("^"))
    return fmt::format("a power of ten is written `{}e{}`", left->text,
                       gap.text(gap.at + 3, std::min(gap.at + 4, gap.statement.size())));
  if (side_by_side && right->is("end")) return "remove `end`";
  bool const numbered = gap.at == 3 && gap.statement[0].is("(") && gap.statement[1].kind == TokenKind::number && left->is(")");
  if (side_by_side && numbered) return fmt::format("an equation has no number: remove `{}`", gap.text(0, 3));
  if (side_by_side && left->is("return")) return "remove `return`";
  if (side_by_side && (left->is("for") || left->is("while")) && gap.begins_with(left->text))
    return "there are no loops: declare a vector, `state q(3)`, and write its equation once";
  if (side_by_side && right->is("(") && left->text.ends_with('\'')) {
    Token const *inside = gap.next(), *close = gap.next(2), *sign = gap.next(3);
    if (inside != nullptr && close != nullptr && close->is(")"))
      return sign != nullptr && sign->is("=") && inside->kind == TokenKind::number
                 ? fmt::format("an initial value is written `initial {} = {}`", left->text,
                               gap.text(gap.at + 4, gap.statement.size()))
                 : fmt::format("write `{}` without `({})`: a quantity is written without its time", left->text, inside->text);
  }
  bool const conditional = side_by_side && left->is(")") && gap.find("if") < gap.at && gap.find("then") > gap.at;
  if (conditional) return "a value that depends on a condition is written `if condition then value else value`";
  if (side_by_side && gap.begins_with("parameter") && gap.find("=") < gap.at && number &&
      ((gap.found_word() && right->text.front() != '_') || right->is("(")) && end_of_unit(gap.statement, gap.at) == gap.at)
    return fmt::format("remove `{}`, or write an uncertain value as a prior: `{} ~ normal({}, sd = 1)`", gap.rest(),
                       gap.text(0, gap.find("=")), left->text);
  if (gap.begins_with("parameter") && right->is("..") && number && gap.next() != nullptr)
    return fmt::format("a range of values is a prior: `{} ~ uniform({}, {})`", gap.text(0, gap.find("=")), left->text,
                       gap.text(gap.at + 1, gap.statement.size()));
  if (gap.begins_with("parameter") && right->is("~") && gap.find("=") < gap.at)
    return fmt::format("a parameter has a prior or a value: `{} {}`", gap.text(0, gap.find("=")), gap.rest());
  if (right->is(".") && gap.at + 1 == gap.statement.size()) return "remove the `.`";
  std::string_view const first = gap.statement[0].text;
  bool const keyword = words::contains(words::model_statements, first) || words::contains(words::data_statements, first) ||
                       words::contains(words::dictionary_statements, first) || is_task(gap);
  if (!keyword && right->is("=") && gap.wanted == wanted::end_of_statement && gap.find("=") < gap.at &&
      left->kind != TokenKind::symbol)
    return fmt::format("an equation has one `=`: remove `{}`, or write two equations", gap.rest());
  if (right->is("+") && gap.wanted == wanted::value && !left->is("+") && !left->is("-") && !left->is("*") && !left->is("/"))
    return "remove the `+`";
  if (right->is("*") && left->is("(") && gap.wanted == wanted::value) return "a comment begins with `#` or `//`";
  return {};
}

}  // namespace

std::string instead_of_inner_block(std::string_view word) {
  constexpr std::array<std::string_view, 5> of_equations{"equations", "equation", "dynamics", "ode", "odes"};
  if (words::contains(of_equations, word)) return "a model has no blocks inside: write the equations without `{` and `}`";
  std::string_view const ours = words::translated(words::foreign_model_statements(), word);
  if (!ours.empty()) word = ours;
  if (word.ends_with('s')) word.remove_suffix(1);
  if (!words::contains(words::model_statements, word)) return {};
  return fmt::format("a model has no blocks inside: begin each of these lines with `{}`, and remove `{{` and `}}`", word);
}

std::string hint_in_model(Gap const& gap) {
  if (gap.statement.empty()) return {};
  for (auto const look : {&description, &inner_block, &behind_distribution, &at_distribution, &behind_declared, &in_unit,
                          &at_bracket, &in_definition, &in_initial, &in_disturbance, &of_other_language, &in_expression})
    if (std::string help = look(gap); !help.empty()) return help;
  return {};
}

}  // namespace sysid::grammar
