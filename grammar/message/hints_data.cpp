// What people write in data blocks, and how it is written here.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "grammar/message/errors.hpp"
#include "grammar/message/explain.hpp"
#include "grammar/message/hints.hpp"
#include "syntax/foreign_words.hpp"
#include "syntax/words.hpp"

namespace sysid::grammar {

namespace {

constexpr std::array<std::string_view, 4> heads{"file", "time", "rate", "step"};

/// What other programs do to a column.
constexpr std::array<std::string_view, 26> column_functions{
    "offset", "downsample", "detrend",  "demean",  "filter",   "filtfilt", "smooth",   "diff",    "cumsum",
    "abs",    "log",        "log10",    "sqrt",    "exp",      "sin",      "cos",      "mean",    "scale",
    "zscore", "normalize",  "gradient", "lowpass", "highpass", "movmean",  "resample", "decimate"};

/// What stands before the number of a column.
constexpr std::array<std::string_view, 4> counts_columns{"column", "col", "field", "index"};
constexpr std::array<std::string_view, 4> arithmetic{"*", "/", "+", "-"};
constexpr std::array<std::string_view, 6> beginnings{"start", "from", "begin", "after", "since", "skip"};
constexpr char const* part_of_record =
    "to use a part of the record, name its rows, `split part = rows 101..500`, and use `DATA.part`";

bool is_name(Token const* token) { return token != nullptr && token->kind == TokenKind::word; }
bool is_numeral(Token const* token) { return token != nullptr && token->kind == TokenKind::number; }

/// `time column 1 [s]`, `measure d = 3 [mm]`: what stands before the column, and what stands behind its number.
std::string counted_column(Gap const& gap, std::string_view before) {
  return fmt::format("a column is named, not counted: write its name from the header of the file, `{} NAME{}{}`", before,
                     gap.next() == nullptr ? "" : " ", gap.text(gap.at + 1, gap.statement.size()));
}

/// `input f = test.force`, `time run(1)`: the name of a column that is not a word, up to a blank or its unit.
std::string in_name_of_column(Gap const& gap) {
  bool const within = gap.wanted == wanted::end_of_statement && (gap.found->is(".") || gap.found->is("("));
  if (!within || !is_name(gap.before()) || gap.before()->span.end != gap.found->span.begin) return {};
  if (gap.found->is("(") && is_name(gap.next()) && words::contains(column_functions, gap.before()->text))
    return fmt::format("a column is used as it is: write `{} {}`, and compute what it needs in the model or before",
                       gap.text(0, gap.at - 1), gap.next()->text);
  std::size_t end = gap.at;
  while (end < gap.statement.size() && gap.statement[end].span.begin == gap.statement[end - 1].span.end &&
         !gap.statement[end].is("[") && !gap.statement[end].is(";"))
    ++end;
  return fmt::format("the name of a column is written in quotes unless it is a single word: `{} \"{}\"`", gap.text(0, gap.at - 1),
                     gap.text(gap.at - 1, end));
}

/// `time step 0.02 [s]`, `time column 1 [s]`, `time t [s] + 3`.
std::string behind_time(Gap const& gap) {
  if (gap.wanted != wanted::end_of_statement) return {};
  if (gap.at == 2 && is_numeral(gap.found) && words::contains(counts_columns, gap.before()->text))
    return counted_column(gap, "time");
  bool const unit = gap.next() != nullptr && gap.next()->is("[");
  if (gap.at == 2 && is_numeral(gap.found) && unit)
    return fmt::format(
        "rows at equal steps are written `step {0}` in a data block; a model in discrete time has `time discrete {0}`", gap.rest());
  if (gap.before()->is("]") && words::contains(arithmetic, gap.found->text))
    return fmt::format("a column is used as it is, with the unit of its numbers: remove `{}`", gap.rest());
  return {};
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
  if (gap.wanted == wanted::end_of_statement && gap.at > 1 && words::contains(beginnings, gap.found->text))
    return fmt::format("remove `{}`; {}", gap.rest(), part_of_record);
  if (std::string const setting = errors::setting_of_reading(gap.found->text);
      gap.wanted == wanted::end_of_statement && !setting.empty())
    return setting;
  if (gap.begins_with("time") && gap.at > 0)
    if (std::string help = behind_time(gap); !help.empty()) return help;
  if (gap.begins_with("time") && gap.at == 2) return in_name_of_column(gap);
  if (gap.begins_with("time") && gap.at == 1 && is_numeral(gap.found))
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
  if (gap.found->is(",") && is_name(gap.next()) && (gap.next()->is("hold") || hold > gap.at))
    return fmt::format("remove the comma: `{} hold {}`", column,
                       gap.next()->is("hold") && gap.next(2) != nullptr ? gap.next(2)->text : gap.next()->text);
  if (hold < gap.at) {
    Token const* const word = gap.found->is("-") ? gap.next() : gap.found;
    std::string const joined = is_name(word) ? fmt::format("{}_{}", gap.before()->text, word->text) : std::string();
    if (gap.at == hold + 2 && is_name(word) && joined != "zero_order" && joined != "band_limited" && joined != "first_order" &&
        joined != "first_order_hold" && joined != "zero_order_hold")
      return fmt::format("remove `{}`", gap.rest());
    if (gap.at == hold + 2 && is_name(word))
      return fmt::format("the rule is one word: `hold {}_{}`", gap.before()->text, word->text);
    if (gap.at == hold + 1 && gap.found->is("(") && is_name(gap.next()))
      return fmt::format("write the rule without parentheses: `hold {}`", gap.next()->text);
    if (gap.at == hold + 1 && gap.found->kind == TokenKind::text && gap.found->text.size() > 2)
      return fmt::format("write the rule without quotes: `hold {}`", gap.found->text.substr(1, gap.found->text.size() - 2));
    if (gap.found->is("["))
      return fmt::format("the unit comes after the column: `{} {} {}`", column, gap.rest(), gap.text(hold, gap.at));
    return {};
  }
  if (!is_name(gap.found)) return {};
  Token const* const rule = gap.next() != nullptr && is_name(gap.next()) ? gap.next() : gap.found;
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
  if (!(input || gap.begins_with("measure")) || gap.at < 2) return {};
  if (gap.wanted == wanted::equals && gap.found == nullptr && gap.at == 2)
    return fmt::format("the column of the file comes after `=`: `{} = COLUMN{}`", gap.text(0, 2), input ? " hold linear" : "");
  if (gap.found == nullptr) return {};
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
  bool const operates = words::contains(arithmetic, gap.found->text), behind_unit = operates && gap.before()->is("]");
  bool const counted = gap.wanted == wanted::column && is_numeral(gap.found) &&
                       (gap.next() == nullptr || gap.next()->is("[") || gap.next()->is("hold"));
  bool const by_word = gap.at == equals + 2 && is_numeral(gap.found) && words::contains(counts_columns, gap.before()->text);
  if (counted || by_word) return counted_column(gap, fmt::format("{} {} =", word, name));
  bool const computed = gap.wanted == wanted::column ? !gap.found->is("[") : operates && (gap.at == equals + 2 || behind_unit);
  if (computed) {
    std::string_view column = behind_unit ? gap.text(equals + 1, gap.at) : std::string_view();
    for (std::size_t i = equals + 1; i < gap.statement.size() && column.empty(); ++i)
      if (gap.statement[i].kind == TokenKind::word && !gap.statement[i].is("hold")) column = gap.statement[i].text;
    return fmt::format("a column is used as it is: write `{} {} = {}`{}, and any factor or offset in the model", word, name,
                       column.empty() ? "COLUMN" : column, behind_unit ? "" : " with the unit of its numbers");
  }
  if (gap.wanted != wanted::end_of_statement && !(input && gap.wanted == wanted::name)) return {};
  bool const again = gap.found->is(",") && gap.next(2) != nullptr && is_name(gap.next()) && gap.next(2)->is("=");
  if (again && is_numeral(gap.next(3)))
    return input ? fmt::format("the error of an input is a distribution around its samples: `{} error normal(sd = {})`",
                               gap.text(0, gap.at), gap.text(gap.at + 3, gap.statement.size()))
                 : fmt::format("the noise is written in the model, after `observe {} ~`: remove `{}`", name, gap.rest());
  if (again) return fmt::format("begin a new statement: `{} {}`", word, gap.text(gap.at + 1, gap.statement.size()));
  if (gap.found->is("in") && is_name(gap.next()) && end_of_unit(gap.statement, gap.at + 1) > gap.at + 1)
    return fmt::format("a unit is written in brackets: `{} [{}]`", gap.before()->text,
                       gap.text(gap.at + 1, end_of_unit(gap.statement, gap.at + 1)));
  if (input) return in_rule(gap, gap.text(0, std::min(gap.at, gap.find("hold"))));
  if (gap.found->is("hold")) return fmt::format("only inputs have a rule between samples: remove `{}`", gap.rest());
  if (gap.found->is("~") || (is_name(gap.found) && gap.next() != nullptr && gap.next()->is("=")))
    return fmt::format("the noise is written in the model, after `observe {} ~`: remove `{}`", name, gap.rest());
  bool const unit = gap.found_word() && end_of_unit(gap.statement, gap.at) > gap.at;
  if (gap.found_word() && !unit && gap.before()->is("]"))
    return fmt::format("remove `{}`: a column is used as it is, and any factor, offset or weight is written in the model",
                       gap.rest());
  return {};
}

/// `read decimal ","`, `read encoding = utf-8`.
std::string in_reading(Gap const& gap) {
  if (!gap.begins_with("read") || gap.found == nullptr) return {};
  if (gap.wanted == wanted::equals && gap.at == 2) return fmt::format("write `{} = {}`", gap.text(0, 2), gap.rest());
  bool const hyphen = gap.wanted == wanted::end_of_statement && gap.found->is("-") && is_name(gap.before());
  if (hyphen && is_numeral(gap.next())) return fmt::format("write it as one word: `{}{}`", gap.text(0, gap.at), gap.next()->text);
  return {};
}

std::string in_split(Gap const& gap) {
  if (!gap.begins_with("split") || gap.found == nullptr) return {};
  bool const range = gap.next() != nullptr && (gap.next()->is("..") || gap.next()->is("-") || gap.next()->is("to"));
  if (gap.wanted == "`rows`" && (gap.found->is("time") || (is_numeral(gap.found) && !range)))
    return "a range is written by the numbers of its rows, which `sysid data FILE` counts: `split train = rows 1..500`";
  if (gap.found->is("and") || (gap.found->is("=") && gap.find("and") < gap.at)) {
    std::size_t const both = gap.find("and");
    return fmt::format("separate ranges by commas: `{}, {}`", gap.text(0, both), gap.text(both + 1, gap.statement.size()));
  }
  bool const apart = gap.wanted == wanted::operator_between && is_name(gap.found) && gap.next() != nullptr && gap.next()->is("=");
  if (apart) return fmt::format("separate ranges by commas: `{}, {}`", gap.text(0, gap.at), gap.rest());
  return {};
}

/// `angle = phi [deg]`, `added = 0.5 [kg]`, `angle [deg] = phi`: a column or a value without its keyword.
std::string without_keyword(Gap const& gap) {
  std::string_view const name = gap.found->text;
  Token const *sign = gap.next(), *value = gap.next(2);
  if (sign == nullptr || value == nullptr) return {};
  if (sign->is("=") && is_numeral(value)) return fmt::format("a value of this record is written `constant {}`", gap.rest());
  if (sign->is("=") && (is_name(value) || value->kind == TokenKind::text))
    return fmt::format("a column is measured or an input: `measure {0}`, `input {0} hold linear`", gap.rest());
  std::size_t const close = sign->is("[") ? gap.closing(1) : gap.statement.size();
  if (close + 2 < gap.statement.size() && gap.statement[close + 1].is("="))
    return fmt::format("a column is measured or an input, and its unit comes last: `measure {} = {} {}`", name,
                       gap.statement[close + 2].text, gap.text(1, close + 1));
  return {};
}

}  // namespace

std::string instead_of_data_statement(Gap const& gap) {
  if (gap.found == nullptr || gap.at != 0) return {};
  std::string const word(gap.found->text);
  if (word == "sheet") return "a file holds one table: save the sheet as CSV";
  if (words::contains(beginnings, word)) return part_of_record;
  if (words::contains(column_functions, word))
    return "a column is used as it is: filter or thin the record before, and write a factor or an offset in the model";
  bool const rows = gap.find("..") < gap.statement.size();
  bool const guessed = rows || !words::translated(words::foreign_data_statements(), word).empty() ||
                       !did_you_mean(word, words::list(words::data_statements)).empty();
  return guessed ? std::string() : without_keyword(gap);
}

std::string hint_in_data(Gap const& gap) {
  for (auto const look : {&in_head, &in_column, &in_reading, &in_split})
    if (std::string help = look(gap); !help.empty()) return help;
  return {};
}

}  // namespace sysid::grammar
