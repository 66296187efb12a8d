// What people write in sets of candidates, dictionaries and tasks, and how it is written here.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "grammar/message/explain.hpp"
#include "grammar/message/hints.hpp"
#include "syntax/words.hpp"

namespace sysid::grammar {

namespace {

bool is_word(Token const* token) { return token != nullptr && token->kind == TokenKind::word; }
bool is_number(Token const* token) { return token != nullptr && token->kind == TokenKind::number; }

/// `use "hysteresis"`, `use hysteresis.sysid`, `use a, b`.
std::string in_use(Gap const& gap) {
  if (!gap.begins_with("use") || gap.found == nullptr) return {};
  if (gap.at == 1 && gap.found->kind == TokenKind::text && gap.found->text.size() > 2) {
    std::string_view const quoted = gap.found->text.substr(1, gap.found->text.size() - 2);
    return fmt::format("a module is named without quotes: `use {}`", quoted.substr(0, quoted.find('.')));
  }
  if (gap.found->is(",") && gap.next() != nullptr) return fmt::format("begin a new line: `use {}`", gap.next()->text);
  if (gap.found->is(".") && gap.next() != nullptr)
    return fmt::format("a module is one word: `use {}`", gap.next()->is("sysid") ? gap.before()->text : gap.next()->text);
  return gap.at >= 2 ? fmt::format("remove `{}`", gap.rest()) : std::string();
}

std::string in_part(Gap const& gap) {
  if (!gap.begins_with("part") || gap.found == nullptr) return {};
  if (gap.at == 2 && gap.wanted == wanted::equals && is_word(gap.found))
    return fmt::format("the name of the part comes first: `part {} = {}{}`", gap.found->text, gap.statement[1].text,
                       gap.text(3, gap.statement.size()));
  if (gap.at == 3 && is_word(gap.found) && is_word(gap.next())) return fmt::format("remove `{}`", gap.found->text);
  if (gap.at == 3 && is_word(gap.found) && gap.next() == nullptr)
    return fmt::format("a part has its arguments in parentheses: `{}()`", gap.rest());
  return {};
}

/// A candidate with its prior probability, in other words.
std::string in_candidates(Gap const& gap) {
  bool const here = gap.wanted == wanted::end_of_statement && gap.at == 1 && gap.found != nullptr;
  std::string_view const model = gap.statement[0].text;
  if (here && (gap.found->is(",") || gap.found->is("or")) && is_word(gap.next()))
    return fmt::format("write each candidate on a line of its own: `{}`, then `{}`", model, gap.next()->text);
  if (gap.statement.size() > 1 && gap.statement[1].is("probability") && gap.found_is("=") && gap.next() != nullptr)
    return fmt::format("write it without `=`: `{} probability {}`", model, gap.next()->text);
  if (gap.statement.size() > 1 && gap.statement[1].is("probability") && gap.found_is("%") && is_number(gap.before()))
    return fmt::format("a probability is written as a number: `{} probability {:g}`", model,
                       std::stod(std::string(gap.before()->text)) / 100);
  if (!here || gap.statement[0].kind != TokenKind::word) return {};
  if (gap.statement[0].is("model") && is_word(gap.found)) return "remove `model`: a candidate is the name of a model alone";
  for (std::size_t i = 1; i < std::min<std::size_t>(4, gap.statement.size()); ++i)
    if (gap.statement[i].kind == TokenKind::number && (gap.found->is("=") || is_number(gap.found) || gap.found->is("p") ||
                                                       gap.found->is("prob") || gap.found->is("prior") || gap.found->is("weight")))
      return fmt::format("the prior probability of a candidate is written `{} probability {}`", model, gap.statement[i].text);
  return {};
}

std::string in_dictionary(Gap const& gap) {
  if (!gap.begins_with("target") || gap.found == nullptr) return {};
  std::size_t const first = gap.find("="), second = gap.find("=", first + 1);
  if (gap.at == first || (gap.at == 1 && first < gap.statement.size()) || second < gap.statement.size()) {
    std::size_t const begin = gap.at == 1 ? 1 : first + 1, equals = gap.at == 1 ? first : second;
    if (equals + 1 < gap.statement.size() && begin < equals)
      return fmt::format("a target is a difference, not an equation: `target = {} - ({})`", gap.text(begin, equals),
                         gap.text(equals + 1, gap.statement.size()));
  }
  return {};
}

/// Around the subject and the data of a task.
std::string in_task_head(Gap const& gap, std::size_t verb) {
  Token const& found = *gap.found;
  bool const ends = gap.wanted == wanted::preposition_or_end || gap.wanted == wanted::with_or_end;
  bool const after_fits = gap.wanted == wanted::preposition_or_end && gap.statement[verb].is("predict") && gap.before() != nullptr;
  if (after_fits && (found.is("and") || found.is("&") || found.is("+")) && is_word(gap.next()))
    return fmt::format("separate the fits of an average by commas: `predict {}, {}`", gap.text(verb + 1, gap.at), gap.next()->text);
  if (after_fits && is_word(gap.found) && gap.next() != nullptr && (gap.next()->is("on") || gap.next()->is(",")))
    return fmt::format("separate the fits of an average by commas: `predict {}, {}`", gap.text(verb + 1, gap.at), found.text);
  if (after_fits && gap.before()->is("on") && gap.before(2) != nullptr && gap.before(2)->is(","))
    return "remove the comma before `on`";
  if (gap.wanted == "the name of a data block" && (found.is("[") || found.is("(")) && gap.closing(gap.at) < gap.statement.size())
    return fmt::format("list the data without brackets: `{}`", gap.text(gap.at + 1, gap.closing(gap.at)));
  if (gap.wanted == "the name of a data block" && found.kind == TokenKind::text)
    return "name a data block: `to DATA`; the CSV file is named inside that block";
  if (gap.wanted == "the name of a data block" && found.is("*")) return "name each data block: `to DATA, OTHER_DATA`";
  if (!ends || gap.before() == nullptr) return {};
  std::size_t const with = std::min(gap.find("with"), gap.statement.size());
  if (gap.wanted == wanted::preposition_or_end && found.is("=") && gap.at == verb + 2 && gap.next() != nullptr)
    return fmt::format("the name of the task comes first: `{} = {} {}`", gap.before()->text, gap.statement[verb].text,
                       gap.text(gap.at + 1, gap.statement.size()));
  if (gap.wanted == wanted::preposition_or_end && (gap.before()->is("model") || gap.before()->is("data")) && is_word(gap.found))
    return fmt::format("remove `{}`: write `{} {}`", gap.before()->text, gap.statement[verb].text, found.text);
  if (gap.wanted == wanted::preposition_or_end && found.is(".") && gap.statement[verb].is("predict") && is_word(gap.next()))
    return fmt::format("remove `{}`: a prediction is made from all draws of a fit", gap.text(gap.at, gap.at + 2));
  if (gap.wanted == wanted::preposition_or_end && found.is(",") && gap.statement[verb].is("select"))
    return "the models are listed in a block of their own, `candidates NAME { ... }`, each in a line: `select NAME to DATA`";
  if (gap.wanted == wanted::preposition_or_end && (found.is(".") || found.is(",")) && gap.next() != nullptr)
    return fmt::format("a model is fitted `to` data, a fit predicts `on` data: `{} {} {} {}`", gap.statement[verb].text,
                       gap.statement[verb].is("predict") ? "FIT" : "MODEL", gap.statement[verb].is("predict") ? "on" : "to",
                       found.is(",") ? gap.text(gap.at + 1, with) : gap.text(gap.at - 1, gap.at + 2));
  bool const part = (found.is("[") || found.is("(")) && is_word(gap.next()) && gap.closing(gap.at) == gap.at + 2;
  if (gap.wanted == wanted::with_or_end && part)
    return gap.before()->is("data") ? fmt::format("name the data block alone: `{}`", gap.next()->text)
                                    : fmt::format("a range of the data is written `{}.{}`", gap.before()->text, gap.next()->text);
  if (found.is(".") && gap.at + 2 <= gap.statement.size())
    return fmt::format("a range has no ranges of its own: remove `{}`", gap.text(gap.at, gap.at + 2));
  bool const joined = (found.is("and") || found.is("&") || found.is("+")) && is_word(gap.next());
  bool const apart = gap.wanted == wanted::with_or_end && is_word(gap.found) && gap.next() != nullptr && gap.next()->is("with");
  if (joined || apart)
    return fmt::format("separate data by commas: `{}, {}`",
                       gap.text(gap.find("to") < gap.at ? gap.find("to") + 1 : gap.at - 1, gap.at),
                       gap.text(joined ? gap.at + 1 : gap.at, with));
  constexpr std::array<std::string_view, 5> spans{"for", "over", "until", "next", "during"};
  if (is_word(gap.found) && words::contains(spans, found.text))
    return fmt::format(
        "a task has the rows of its data: remove `{}`; a range of rows is named in the data block, `split part = rows "
        "101..500`, and used as `DATA.part`",
        gap.text(gap.at, with));
  if (found.is("rows") && is_number(gap.next()))
    return fmt::format("a range of rows is named in the data block: `split part = {}`, and used as `{}.part`",
                       gap.text(gap.at, with), gap.before()->text);
  if (is_word(gap.found) && is_number(gap.next()))
    return fmt::format("options follow `with`: `with {} = {}`", found.text, gap.next()->text);
  return {};
}

/// `with map with mh`, `with map with seed = 1`.
std::string second_with(Gap const& gap, std::size_t first) {
  Token const* const sign = gap.next(2);
  if (sign != nullptr && sign->is("="))
    return fmt::format("write `with` only once, and separate options by commas: `{}, {}`", gap.text(first, gap.at),
                       gap.text(gap.at + 1, gap.statement.size()));
  std::size_t const behind = sign != nullptr && sign->is("(") ? gap.closing(gap.at + 2) + 1 : gap.at + 2;
  return fmt::format("a task has one back end: write `{}{}` or `with {}`", gap.text(first, gap.at),
                     gap.text(behind, gap.statement.size()), gap.text(gap.at + 1, gap.statement.size()));
}

/// Among the options of a task.
std::string in_options(Gap const& gap) {
  std::size_t const with = gap.find("with");
  if (with >= gap.at || gap.before() == nullptr) return {};
  Token const& found = *gap.found;
  bool const side_by_side = gap.wanted == wanted::operator_between;
  if (found.is(",") && gap.before()->is(",")) return "remove one comma";
  if (found.is(")") && gap.before()->is(",")) return "remove the comma before `)`";
  // `mh samples = 100`: settings of a back end without parentheses.
  bool const settings = side_by_side && gap.at == with + 2 && is_word(gap.before()) && is_word(gap.found) &&
                        gap.next() != nullptr && gap.next()->is("=");
  if (settings && found.is("seed")) return fmt::format("write a comma: `with {}, {}`", gap.before()->text, gap.rest());
  if (settings) {
    std::size_t const end = gap.find("seed", gap.at);
    std::size_t const last =
        end < gap.statement.size() && gap.statement[end - 1].is(",") ? end - 1 : std::min(end, gap.statement.size());
    return fmt::format("settings of a back end stand in its parentheses, separated by commas: `{}({})`", gap.before()->text,
                       gap.text(gap.at, last));
  }
  if (found.is("with") && is_word(gap.next())) return second_with(gap, with);
  std::size_t const start = gap.find("start", with);
  if (found.is("=") && start + 2 < gap.at && gap.statement[start + 1].is("=") && gap.statement[start + 2].is("(") &&
      gap.closing(start + 2) < gap.statement.size())
    return fmt::format("remove `{}`: a fit has no start values, its search begins at draws of the prior",
                       gap.text(start, gap.closing(start + 2) + 1));
  // The first word is the back end.
  if (side_by_side && gap.at == with + 2 && is_word(gap.before()) && is_word(gap.found))
    return is_number(gap.next())
               ? fmt::format("write a comma and `=`: `with {}, {} = {}`", gap.before()->text, found.text,
                             gap.text(gap.at + 1, gap.statement.size()))
               : fmt::format("remove `{}`: options follow a comma, `with {}, seed = 1`", gap.rest(), gap.before()->text);
  if (side_by_side && is_word(gap.before()) && is_word(gap.found) && gap.before(2) != nullptr &&
      (gap.before(2)->is(",") || gap.before(2)->is("with")))
    return fmt::format("an option is written `{} = {}`", gap.before()->text, gap.rest());
  if (side_by_side && is_number(gap.before()) && is_word(gap.found) && gap.before(2) != nullptr &&
      (gap.before(2)->is(",") || gap.before(2)->is("with")))
    return fmt::format("an option is written `{} = {}`", found.text, gap.before()->text);
  if (side_by_side && is_number(gap.before()) && gap.before()->span.end == found.span.begin &&
      (found.is("k") || found.is("K") || found.is("M")))
    return fmt::format("write `{}e{}`", gap.before()->text, found.is("M") ? 6 : 3);
  if (found.is("..") && is_number(gap.before()) && is_number(gap.next()))
    return fmt::format("a range of rows is named in the data block: `split part = rows {}`, and used as `DATA.part`",
                       gap.text(gap.at - 1, gap.at + 2));
  if (found.is("=") && gap.find("and") < gap.at) return "separate options by commas in place of `and`";
  if (gap.wanted == wanted::equals && gap.before(2) != nullptr && gap.before(2)->is("input"))
    return fmt::format("the signal of an input is written `input {} = {}`", gap.before()->text,
                       found.is("~") ? gap.text(gap.at + 1, gap.statement.size()) : gap.rest());
  return {};
}

std::string in_task(Gap const& gap) {
  std::size_t const verb = gap.statement.size() > 2 && gap.statement[1].is("=") ? 2 : 0;
  if (gap.found == nullptr || gap.statement.size() <= verb || !words::contains(words::verbs, gap.statement[verb].text)) return {};
  if (verb == 0 && gap.wanted == wanted::name && gap.at == 1 && (gap.found->is("-") || gap.found->is(".")) &&
      gap.next(2) != nullptr && gap.next(2)->is("="))
    return fmt::format("a name is made of letters, digits and `_`: `{}_{} = ...`", gap.before()->text, gap.next()->text);
  std::string head = in_task_head(gap, verb);
  return head.empty() ? in_options(gap) : head;
}

/// A comma at the end of a line, before a statement that is none of a list.
std::string at_comma(Gap const& gap) {
  if (!gap.found_is(",") || gap.wanted != wanted::end_of_statement) return {};
  return gap.next() == nullptr || gap.next()->newline_before ? "remove the comma" : "";
}

/// `data bench` and on the next line `{`.
std::string at_brace(Gap const& gap) {
  if (gap.wanted != wanted::opening_brace || gap.statement.size() < 2 || !words::contains(words::blocks, gap.statement[0].text))
    return {};
  if (gap.found == nullptr) return fmt::format("write `{{` on this line: `{} {{`", gap.text(0, gap.statement.size()));
  if (gap.found->is("=") && gap.at == 2) return fmt::format("write it without `=`: `{} {{`", gap.text(0, 2));
  return {};
}

}  // namespace

std::string hint_in_block(Gap const& gap) {
  if (gap.statement.empty()) return {};
  for (auto const look : {&hint_in_data, &in_use, &in_part, &in_candidates, &in_dictionary, &in_task, &at_comma, &at_brace})
    if (std::string help = look(gap); !help.empty()) return help;
  return {};
}

}  // namespace sysid::grammar
