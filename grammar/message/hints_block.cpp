// What people write in data blocks, sets of candidates, dictionaries and tasks, and how it is written here.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "grammar/message/explain.hpp"
#include "grammar/message/hints.hpp"
#include "syntax/foreign_words.hpp"
#include "syntax/words.hpp"

namespace sysid::grammar {

namespace {

constexpr std::array<std::string_view, 4> heads{"file", "time", "rate", "step"};

/// What other programs do to a column.
constexpr std::array<std::string_view, 24> column_functions{"detrend",  "demean",  "filter",   "filtfilt", "smooth",   "diff",
                                                            "cumsum",   "abs",     "log",      "log10",    "sqrt",     "exp",
                                                            "sin",      "cos",     "mean",     "scale",    "zscore",   "normalize",
                                                            "gradient", "lowpass", "highpass", "movmean",  "resample", "decimate"};

bool is_word(Token const* token) { return token != nullptr && token->kind == TokenKind::word; }
bool is_number(Token const* token) { return token != nullptr && token->kind == TokenKind::number; }

/// `input f = test.force`, `time run(1)`: the name of a column that is not a word, up to a blank or its unit.
std::string in_name_of_column(Gap const& gap) {
  bool const within = gap.wanted == wanted::end_of_statement && (gap.found->is(".") || gap.found->is("("));
  if (!within || !is_word(gap.before()) || gap.before()->span.end != gap.found->span.begin) return {};
  if (gap.found->is("(") && is_word(gap.next()) && words::contains(column_functions, gap.before()->text))
    return fmt::format("a column is used as it is: write `{} {}`, and compute what it needs in the model or before",
                       gap.text(0, gap.at - 1), gap.next()->text);
  std::size_t end = gap.at;
  while (end < gap.statement.size() && gap.statement[end].span.begin == gap.statement[end - 1].span.end &&
         !gap.statement[end].is("[") && !gap.statement[end].is(";"))
    ++end;
  return fmt::format("the name of a column is written in quotes unless it is a single word: `{} \"{}\"`", gap.text(0, gap.at - 1),
                     gap.text(gap.at - 1, end));
}

/// `rate = 100 [Hz]`, `file("a.csv")`, `time [s] t`: statements without a sign.
std::string in_head(Gap const& gap) {
  if (!words::contains(heads, gap.statement[0].text) || gap.found == nullptr) return {};
  if (gap.at == 1 && (gap.found->is("=") || gap.found->is("~")) && gap.next() != nullptr)
    return fmt::format("write it without `{}`: `{} {}`", gap.found->text, gap.statement[0].text, gap.text(2, gap.statement.size()));
  if (gap.at == 1 && gap.found->is("(") && gap.closing(1) > 2 && gap.closing(1) < gap.statement.size())
    return fmt::format("write it without parentheses: `{} {}`", gap.statement[0].text, gap.text(2, gap.closing(1)));
  if (gap.at == 1 && gap.found->is("[") && gap.closing(1) < gap.statement.size()) {
    std::size_t const close = gap.closing(1);
    if (close + 1 < gap.statement.size())
      return fmt::format("the unit comes last: `{} {} {}`", gap.statement[0].text, gap.text(close + 1, gap.statement.size()),
                         gap.text(1, close + 1));
    if (gap.statement[2].kind == TokenKind::text)
      return fmt::format("write it without brackets: `{} {}`", gap.statement[0].text, gap.text(2, close));
    return fmt::format("name the column before its unit: `{} t {}`", gap.statement[0].text, gap.text(1, close + 1));
  }
  bool const another = gap.found->is(",") && gap.next() != nullptr && gap.next()->kind == TokenKind::text;
  if (gap.begins_with("file") && gap.at == 2 && (another || gap.found->kind == TokenKind::text))
    return "a data block reads one file: write a block for each file, and fit to all of them, `to DATA, OTHER_DATA`";
  if (gap.begins_with("time") && gap.at == 2)
    if (std::string const unit = gap.found->is("in") ? unit_without_brackets(gap) : std::string(); !unit.empty())
      return fmt::format("a unit is written in brackets: `time {} {}`", gap.before()->text, unit);
  constexpr std::array<std::string_view, 6> starts{"start", "from", "begin", "after", "since", "skip"};
  if (gap.wanted == wanted::end_of_statement && gap.at > 1 && words::contains(starts, gap.found->text))
    return fmt::format("remove `{}`; to use a part of the record, name its rows, `split part = rows 101..500`, and use `DATA.part`",
                       gap.rest());
  if (gap.begins_with("time") && gap.at == 2) return in_name_of_column(gap);
  if (gap.begins_with("time") && gap.at == 1 && is_number(gap.found))
    return fmt::format("name the column; put it in quotes if it is not a single word: `time \"{}\"`", gap.found->text);
  return {};
}

/// `error 0.5`, `error = 0.5`, `error sd = 0.5`, and a rule behind the error.
std::string in_error(Gap const& gap) {
  std::size_t const error = gap.find("error");
  if (!gap.begins_with("input") || error >= gap.at || error < 3) return {};
  std::size_t const hold = gap.find("hold", error);
  if (gap.found->is("hold") && gap.wanted == wanted::end_of_statement && hold == gap.at)
    return fmt::format("the rule between samples comes before the error: `{} {} {}`", gap.text(0, error), gap.rest(),
                       gap.text(error, gap.at));
  if (!gap.wanted.starts_with("a distribution")) return {};
  std::size_t const sign = gap.find("=", error);
  std::size_t const number = sign < gap.statement.size() ? sign + 1 : gap.at;
  std::size_t const end = std::min(hold, gap.statement.size());
  bool const given = number < end && gap.statement[number].kind == TokenKind::number;
  return fmt::format("the error of an input is a distribution around its samples: `error normal(sd = {})`",
                     given ? gap.text(number, end) : "0.5");
}

/// `, hold linear`, `hold zero-order`, `hold(linear)`, `zoh`: the rule of an input in other words.
std::string in_rule(Gap const& gap, std::string_view column) {
  std::size_t const hold = gap.find("hold");
  if (gap.found->is(",") && is_word(gap.next()) && (gap.next()->is("hold") || hold > gap.at))
    return fmt::format("remove the comma: `{} hold {}`", column,
                       gap.next()->is("hold") && gap.next(2) != nullptr ? gap.next(2)->text : gap.next()->text);
  if (hold < gap.at) {
    Token const* const word = gap.found->is("-") ? gap.next() : gap.found;
    std::string const joined = is_word(word) ? fmt::format("{}_{}", gap.before()->text, word->text) : std::string();
    if (gap.at == hold + 2 && is_word(word) && joined != "zero_order" && joined != "band_limited" && joined != "first_order" &&
        joined != "first_order_hold" && joined != "zero_order_hold")
      return fmt::format("remove `{}`", gap.rest());
    if (gap.at == hold + 2 && is_word(word))
      return fmt::format("the rule is one word: `hold {}_{}`", gap.before()->text, word->text);
    if (gap.at == hold + 1 && gap.found->is("(") && is_word(gap.next()))
      return fmt::format("write the rule without parentheses: `hold {}`", gap.next()->text);
    if (gap.at == hold + 1 && gap.found->kind == TokenKind::text && gap.found->text.size() > 2)
      return fmt::format("write the rule without quotes: `hold {}`", gap.found->text.substr(1, gap.found->text.size() - 2));
    if (gap.found->is("["))
      return fmt::format("the unit comes after the column: `{} {} {}`", column, gap.rest(), gap.text(hold, gap.at));
    return {};
  }
  if (!is_word(gap.found)) return {};
  Token const* const rule = gap.next() != nullptr && is_word(gap.next()) ? gap.next() : gap.found;
  std::string_view const ours = words::translated(words::foreign_input_rules(), rule->text);
  bool const unit = gap.before() != nullptr && !gap.before()->is("]") && end_of_unit(gap.statement, gap.at) > gap.at;
  return unit ? std::string()
              : fmt::format("the rule between samples is written after `hold`: `hold {}`", !ours.empty()      ? ours
                                                                                           : rule->is("hold") ? "linear"
                                                                                                              : rule->text);
}

/// `input x = 2*force [N]`, `input x [N] = force`, `measure d = y [mm] sd = 0.1`.
std::string in_column(Gap const& gap) {
  bool const input = gap.begins_with("input");
  if (!(input || gap.begins_with("measure")) || gap.found == nullptr || gap.at < 2) return {};
  if (std::string help = in_error(gap); !help.empty()) return help;
  std::size_t const equals = gap.find("=");
  std::string_view const word = gap.statement[0].text, name = gap.statement[1].text;
  if (gap.wanted == wanted::equals) {
    std::size_t const close = gap.closing(gap.at);
    if (gap.found->is("[") && close + 2 < gap.statement.size() && gap.statement[close + 1].is("="))
      return fmt::format("the unit comes after the column: `{} {} = {} {}`", word, name, gap.statement[close + 2].text,
                         gap.text(gap.at, close + 1));
    bool const law = gap.found->is("~") && gap.next(2) != nullptr && gap.next(2)->is("(");
    if (law && !input)
      return fmt::format("a column is named here, `measure {0} = COLUMN`; its noise is written in the model, `observe {0} ~ ...`",
                         name);
    if ((gap.found->is("from") || gap.found->is("~") || gap.found->is("as")) && gap.next() != nullptr)
      return fmt::format("write `=`: `{} {} = {}`", word, name, gap.text(gap.at + 1, gap.statement.size()));
    return {};
  }
  if (equals >= gap.at) return {};
  if (std::string help = in_name_of_column(gap); !help.empty()) return help;
  constexpr std::array<std::string_view, 4> operators{"*", "/", "+", "-"};
  bool const operates = words::contains(operators, gap.found->text), behind_unit = operates && gap.before()->is("]");
  bool const counted = gap.wanted == wanted::column && is_number(gap.found) &&
                       (gap.next() == nullptr || gap.next()->is("[") || gap.next()->is("hold"));
  if (counted)
    return fmt::format("a column is named, not counted: write its name from the header of the file, `{} {} = NAME{}{}`", word, name,
                       gap.next() == nullptr ? "" : " ", gap.text(gap.at + 1, gap.statement.size()));
  bool const computed = gap.wanted == wanted::column ? !gap.found->is("[") : operates && (gap.at == equals + 2 || behind_unit);
  if (computed) {
    std::string_view column = behind_unit ? gap.text(equals + 1, gap.at) : std::string_view();
    for (std::size_t i = equals + 1; i < gap.statement.size() && column.empty(); ++i)
      if (gap.statement[i].kind == TokenKind::word && !gap.statement[i].is("hold")) column = gap.statement[i].text;
    return fmt::format("a column is used as it is: write `{} {} = {}`{}, and any factor or offset in the model", word, name,
                       column.empty() ? "COLUMN" : column, behind_unit ? "" : " with the unit of its numbers");
  }
  if (gap.wanted != wanted::end_of_statement && !(input && gap.wanted == wanted::name)) return {};
  bool const again = gap.found->is(",") && gap.next(2) != nullptr && is_word(gap.next()) && gap.next(2)->is("=");
  if (again && is_number(gap.next(3)))
    return input ? fmt::format("the error of an input is a distribution around its samples: `{} error normal(sd = {})`",
                               gap.text(0, gap.at), gap.text(gap.at + 3, gap.statement.size()))
                 : fmt::format("the noise is written in the model, after `observe {} ~`: remove `{}`", name, gap.rest());
  if (again) return fmt::format("begin a new statement: `{} {}`", word, gap.text(gap.at + 1, gap.statement.size()));
  if (gap.found->is("in") && is_word(gap.next()) && end_of_unit(gap.statement, gap.at + 1) > gap.at + 1)
    return fmt::format("a unit is written in brackets: `{} [{}]`", gap.before()->text,
                       gap.text(gap.at + 1, end_of_unit(gap.statement, gap.at + 1)));
  if (input) return in_rule(gap, gap.text(0, std::min(gap.at, gap.find("hold"))));
  if (gap.found->is("hold")) return fmt::format("only inputs have a rule between samples: remove `{}`", gap.rest());
  if (gap.found->is("~") || (is_word(gap.found) && gap.next() != nullptr && gap.next()->is("=")))
    return fmt::format("the noise is written in the model, after `observe {} ~`: remove `{}`", name, gap.rest());
  bool const unit = gap.found_word() && end_of_unit(gap.statement, gap.at) > gap.at;
  if (gap.found_word() && !unit && gap.before()->is("]"))
    return fmt::format("remove `{}`: a column is used as it is, and any factor, offset or weight is written in the model",
                       gap.rest());
  return {};
}

std::string in_split(Gap const& gap) {
  if (!gap.begins_with("split") || gap.found == nullptr) return {};
  if (gap.found->is("and") || (gap.found->is("=") && gap.find("and") < gap.at)) {
    std::size_t const both = gap.find("and");
    return fmt::format("separate ranges by commas: `{}, {}`", gap.text(0, both), gap.text(both + 1, gap.statement.size()));
  }
  bool const apart = gap.wanted == wanted::operator_between && is_word(gap.found) && gap.next() != nullptr && gap.next()->is("=");
  if (apart) return fmt::format("separate ranges by commas: `{}, {}`", gap.text(0, gap.at), gap.rest());
  return {};
}

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
  for (std::size_t i = 1; i < std::min<std::size_t>(4, gap.statement.size()); ++i)
    if (gap.statement[i].kind == TokenKind::number &&
        (gap.found->is("=") || is_number(gap.found) || gap.found->is("p") || gap.found->is("prob") || gap.found->is("weight")))
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
    return fmt::format("a range of the data is written `{}.{}`", gap.before()->text, gap.next()->text);
  if (found.is(".") && gap.at + 2 <= gap.statement.size())
    return fmt::format("a range has no ranges of its own: remove `{}`", gap.text(gap.at, gap.at + 2));
  if ((found.is("and") || found.is("&")) && is_word(gap.next()))
    return fmt::format("separate data by commas: `{}, {}`",
                       gap.text(gap.find("to") < gap.at ? gap.find("to") + 1 : gap.at - 1, gap.at), gap.text(gap.at + 1, with));
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
  for (auto const look :
       {&in_head, &in_column, &in_split, &in_use, &in_part, &in_candidates, &in_dictionary, &in_task, &at_comma, &at_brace})
    if (std::string help = look(gap); !help.empty()) return help;
  return {};
}

}  // namespace sysid::grammar
