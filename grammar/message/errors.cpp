// The wording of the syntax stage.
#include "grammar/message/errors.hpp"

#include <fmt/format.h>

#include <array>

#include "syntax/foreign_words.hpp"
#include "syntax/words.hpp"

namespace sysid::grammar::errors {

namespace {

Diagnostic error(std::string code, Span where, std::string message, std::string help = "") {
  Diagnostic diagnostic;
  diagnostic.code = std::move(code);
  diagnostic.message = std::move(message);
  diagnostic.primary = Label{where, ""};
  diagnostic.help = std::move(help);
  return diagnostic;
}

/// "`a`, `b` or `c`".
std::string choice(std::span<std::string_view const> words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i)
    out += fmt::format("{}`{}`", i == 0 ? "" : i + 1 == words.size() ? " or " : ", ", words[i]);
  return out;
}

/// A guess when the word is a foreign one or near one of ours, else everything there is.
std::string guess_or(std::string_view word, std::span<words::ForeignWord const> foreign, std::vector<std::string> const& known,
                     std::string all) {
  if (std::string_view const ours = words::translated(foreign, word); !ours.empty()) return fmt::format("did you mean `{}`?", ours);
  std::string guess = did_you_mean(word, known);
  return guess.empty() ? std::move(all) : guess;
}

std::string_view noun(std::string_view bracket) { return bracket == "{" ? "block" : bracket == "[" ? "unit" : "parenthesis"; }
std::string_view closer(std::string_view opener) { return opener == "{" ? "}" : opener == "[" ? "]" : ")"; }

}  // namespace

Diagnostic expected(Span where, std::string_view wanted, std::string_view found, std::string help) {
  return error("E1101", where, fmt::format("expected {} but found {}", wanted, found), std::move(help));
}

Diagnostic semicolon_in_brackets(Span where) {
  return expected(where, "`,` or the closing bracket", "`;`", "separate items in brackets by commas; `;` ends a statement");
}

Diagnostic comma_missing(Token const& before, Token const& behind) {
  return expected(behind.span, "`,`", fmt::format("`{}`", behind.text),
                  fmt::format("write a comma before it: `{}, {}`", before.text, behind.text));
}

Diagnostic two_tasks_on_a_line(Token const& behind) {
  return expected(behind.span, "the end of the task", fmt::format("`{}`", behind.text),
                  fmt::format("begin a new line before `{}`", behind.text));
}

Diagnostic unclosed(Token const& opener, Span noticed) {
  Diagnostic out = error("E1102", noticed, fmt::format("the {} opened with `{}` is not closed", noun(opener.text), opener.text),
                         fmt::format("close it with `{}`", closer(opener.text)));
  out.primary->text = fmt::format("`{}` is missing before this", closer(opener.text));
  out.secondary.push_back({opener.span, "opened here"});
  return out;
}

std::string no_block_inside(Token const& block) {
  return fmt::format("no block stands inside another: move `{} ... {{ ... }}` behind the `}}` of the block around it", block.text);
}

Diagnostic unclosed_text(Span text) {
  Diagnostic out = error("E1103", {text.end, text.end}, "the text in quotes is not closed", "end it with `\"` on the same line");
  out.primary->text = "`\"` is missing here";
  out.secondary.push_back({{text.begin, text.begin + 1}, "opened here"});
  return out;
}

Diagnostic mismatched(Token const& opener, Token const& closing) {
  Diagnostic out = error("E1104", closing.span, fmt::format("`{}` is closed by `{}`", opener.text, closing.text),
                         fmt::format("close it with `{}`", closer(opener.text)));
  out.secondary.push_back({opener.span, "opened here"});
  return out;
}

Diagnostic no_operator_between(Token const& left, Token const& right, std::string_view instead) {
  std::string help = "multiplication is written with `*`";
  if (left.kind != TokenKind::symbol && right.kind != TokenKind::symbol) help += fmt::format(": `{}*{}`", left.text, right.text);
  if (left.kind == TokenKind::word && right.kind == TokenKind::word && !left.text.ends_with('\''))
    help += fmt::format("; if `{0}` is a function, write `{0}({1})`", left.text, right.text);
  if (!instead.empty()) help = fmt::format("{}; {}", instead, help);
  return error("E1105", cover(left.span, right.span),
               fmt::format("there is no operator between `{}` and `{}`", left.text, right.text), std::move(help));
}

Diagnostic chained_comparison(Token const& first, Token const& second) {
  Diagnostic out = error("E1106", second.span, "comparisons cannot be chained",
                         fmt::format("compare twice and join with `and`: `a {} b and b {} c`", first.text, second.text));
  out.secondary.push_back({first.span, "first comparison"});
  return out;
}

Diagnostic dot_without_digits(Span number, std::string_view written, std::string_view repaired) {
  return error("E1107", number, "a number needs digits on both sides of its dot",
               fmt::format("write `{}` in place of `{}`", repaired, written));
}

Diagnostic second_dot(Span number, std::string_view written) {
  return error("E1107", number, fmt::format("the number `{}` has a dot too many", written),
               "a number has one dot, and an exponent is a whole number: `1.5e3`");
}

Diagnostic fortran_exponent(Span number, std::string_view digits, std::string_view exponent) {
  return error("E1129", number, fmt::format("the exponent of `{}{}` is written as in Fortran", digits, exponent),
               fmt::format("write `{0}e{1}`; a product is written `{0}*{2}`", digits, exponent.substr(1), exponent));
}

Diagnostic number_out_of_range(Span number, std::string_view text) {
  return error("E1108", number, fmt::format("the number `{}` is outside the range of double precision", text),
               "magnitudes from 1e-307 to 1e308 can be represented");
}

Diagnostic unknown_statement(Token const& word, std::string_view place, std::span<std::string_view const> known) {
  return error("E1109", word.span, fmt::format("no statement of {} begins with `{}`", place, word.text),
               guess_or(word.text,
                        place == "a model"        ? words::foreign_model_statements()
                        : place == "a data block" ? words::foreign_data_statements()
                                                  : std::span<words::ForeignWord const>(),
                        words::list(known), fmt::format("a statement begins with {}", choice(known))));
}

Diagnostic equation_with_keyword(Token const& word) {
  return error("E1109", word.span, fmt::format("no statement of a model begins with `{}`", word.text),
               fmt::format("an equation has no keyword: remove `{}`", word.text));
}

namespace {

/// Settings of `read`, in words of other programs.
constexpr words::ForeignWord reading_settings[] = {
    {"delimiter", "separator = \",\""},
    {"delim", "separator = \",\""},
    {"sep", "separator = \",\""},
    {"separator", "separator = \",\""},
    {"header", "names = 1"},
    {"names", "names = 1"},
    {"skip", "values = 2"},
    {"skiprows", "values = 2"},
    {"skip_rows", "values = 2"},
    {"values", "values = 2"},
    {"units", "units = 2"},
    {"columns", "columns = (t, force, y)"},
    {"decimal", "decimal = \",\""},
    {"thousands", "thousands = \".\""},
    {"encoding", "encoding = latin1"},
    {"missing", "missing = \"NaN\""},
    {"nan", "missing = \"NaN\""},
    {"na_values", "missing = \"NaN\""},
    {"comment", "comments = \"%\""},
    {"comments", "comments = \"%\""},
    {"stamp", "stamp = iso"},
    {"datetime", "stamp = iso"},
};

}  // namespace

std::string setting_of_reading(std::string_view word) {
  std::string_view const setting = words::translated(reading_settings, word);
  return setting.empty() ? std::string() : fmt::format("how the file is read is written after `read`: `read {}`", setting);
}

std::string place_of_statement(std::string_view word, bool with_tilde) {
  constexpr std::array<std::string_view, 5> of_noise{"noise", "sd", "sigma", "std", "error"};
  if (words::contains(of_noise, word))
    return "the noise of a channel is written in the model, `observe CHANNEL ~ normal(y, sd = 0.1)`: remove this line";
  if (std::string setting = setting_of_reading(word); !setting.empty()) return setting;
  bool const of_model = words::contains(words::model_statements, word) && !words::contains(words::data_statements, word);
  bool const binds = word == "observe" || word == "parameter";  // with `=` they name a column and a value
  return of_model && (with_tilde || !binds) ? fmt::format("`{}` belongs in a model: move this line there", word) : std::string();
}

std::string place_of_output(std::string_view word) {
  constexpr std::array<std::string_view, 8> shows{"plot", "print", "show", "display", "disp", "save", "write", "summary"};
  if (words::contains(shows, word))
    return "a run writes tables, figures and a page of each task: `sysid run FILE -o DIR`; remove this line";
  constexpr std::array<std::string_view, 5> commands{"check", "track", "report", "export", "crosscheck"};
  if (words::contains(commands, word)) return fmt::format("it is a command: `sysid {} --help`; remove this line", word);
  if (word == "compare")
    return "write `select` to choose among candidate models; results are compared by the command `sysid compare`";
  return {};
}

Diagnostic unknown_item(Token const& word) {
  std::vector<std::string> known = words::list(words::items);
  for (std::string_view const verb : words::verbs) known.emplace_back(verb);
  return error(
      "E1110", word.span, fmt::format("no declaration or task begins with `{}`", word.text),
      guess_or(word.text, words::foreign_items(), known,
               fmt::format("a declaration begins with {}; a task begins with {}", choice(words::items), choice(words::verbs))));
}

Diagnostic unknown_verb(Token const& word) {
  return error("E1111", word.span, fmt::format("`{}` is not a task", word.text),
               guess_or(word.text, words::foreign_verbs(), words::list(words::verbs),
                        fmt::format("a task begins with {}", choice(words::verbs))));
}

Diagnostic double_equals(Span where) {
  return error("E1112", where, "`==` is a comparison, not an equation or a definition", "write a single `=`");
}

Diagnostic tilde_missing(Span where, std::string_view keyword, std::string_view repaired) {
  std::string_view const what = keyword == "observe" ? "an observation" : "a prior",
                         form = keyword == "observe" ? "observe channel ~ normal(model, sd = 1)"
                                                     : "parameter name ~ normal(0, sd = 1)";
  return error("E1113", where, "`~` is missing before the distribution",
               fmt::format("{} is written `{}`", what, repaired.empty() ? form : repaired));
}

Diagnostic tilde_without_keyword(Span where) {
  return error("E1114", where, "`~` is used in a statement that declares no prior, observation, disturbance or initial value",
               "begin the statement with `parameter` for a prior, with `observe` for a measured quantity, with `disturbance` for "
               "an unmeasured force or input");
}

Diagnostic other_file(Span begin, std::string const& name, std::string_view kind) {
  return error("E1128", begin, fmt::format("`{}` is not a .sysid file: it looks like {}", name, kind),
               "give a .sysid file, which names the record: `data bench { file \"bench.csv\" ... }`");
}

Diagnostic stray_byte(Span where, unsigned char byte) {
  if (byte >= 0x80U)
    return error("E1115", where, fmt::format("the byte 0x{:02x} is not valid UTF-8", byte), "save the file as UTF-8");
  std::string const name =
      byte > 0x20U && byte < 0x7FU ? fmt::format("`{}`", static_cast<char>(byte)) : fmt::format("0x{:02x}", byte);
  std::string_view const help = byte == '|' ? "an absolute value is written `abs(y)`; arguments are separated by commas"
                                : byte == '?'
                                    ? "a value that depends on a condition is written `if condition then value else value`"
                                : byte == '@' ? "a function is written `function f(y) = k*y`, a product `A*B`"
                                : byte == '`' ? "a derivative is written with primes: `y''`"
                                              : "remove it";
  return error("E1115", where, fmt::format("the character {} has no meaning here", name), std::string(help));
}

Diagnostic no_meaning(Span where, std::string_view found, std::string help) {
  return error("E1115", where, fmt::format("{} {} no meaning here", found, found.ends_with('s') ? "have" : "has"), std::move(help));
}

Diagnostic look_alike(Span where, std::string_view found, std::string_view meant) {
  return error("E1116", where, fmt::format("the character `{}` is not part of the language", found),
               meant.empty() ? "remove it; it may be invisible" : fmt::format("write {}", meant));
}

Diagnostic foreign_operator(Span where, std::string_view found, std::string_view help) {
  return error("E1117", where, fmt::format("`{}` is not an operator", found), std::string(help));
}

Diagnostic left_arrow(Span where) { return foreign_operator(where, "<-", "an equation or a definition is written with `=`"); }

Diagnostic list_in_brackets(Span where, std::string help) {
  return error("E1118", where, "a list is not written in brackets", std::move(help));
}

Diagnostic bounds_in_brackets(Span where) {
  return error("E1118", where, "bounds are not written in brackets",
               "bounds are arguments of the prior: `normal(0, sd = 1, lower = 0, upper = 1)`");
}

Diagnostic range_in_brackets(Span where) {
  return error("E1118", where, "a range of values is not written in brackets", "write it as a prior: `~ uniform(0.1, 10)`");
}

Diagnostic bracket_out_of_place(Span where) {
  return error("E1118", where, "a unit is not allowed here",
               "a unit is allowed only after a number, a declared name or a data column; elsewhere multiply by a number with a "
               "unit: `1 [m]`");
}

Diagnostic reserved_word(Token const& word) {
  return error("E1119", word.span, fmt::format("`{}` is a reserved word and cannot be a name", word.text), "choose another name");
}

Diagnostic begins_with_sign(Token const& sign) {
  return error(
      "E1120", sign.span, fmt::format("a statement cannot begin with `{}`", sign.text),
      "write the first term in parentheses, or begin with another term; a sign at the start of a line continues the line before");
}

Diagnostic prime_apart(Span where, std::string_view number) {
  return error("E1121", where, "a prime must directly follow a name",
               number.empty() ? "write the derivative of `y` as `y'`" : fmt::format("digits are not grouped: write `{}`", number));
}

Diagnostic nesting_too_deep(Span where, int most) {
  return error("E1122", where, fmt::format("the expression has more than {} levels of nesting", most),
               "name parts of it with `let`");
}

Diagnostic statement_too_long(Span where, int most) {
  return error("E1123", where, fmt::format("the statement that begins here has more than {} operators", most),
               "name parts of it with `let`");
}

Diagnostic text_too_large(Span where, std::size_t most) {
  return error("E1126", where, fmt::format("the text is longer than {} bytes, the most that can be read", most),
               "put large tables of numbers into a data file, and repeated models into a module with arguments");
}

Diagnostic word_too_long(Span where, std::ptrdiff_t most) {
  return error("E1127", where, fmt::format("this name is longer than {} characters", most), "choose a shorter name");
}

Diagnostic unknown_escape(Span where, std::string_view escape) {
  return error("E1124", where, fmt::format("`{}` is not an escape", escape),
               "the escapes are `\\\"`, `\\\\` and `\\n`; in a path write `/`");
}

Diagnostic statement_incomplete(Token const& last, Token const& next) {
  Diagnostic out = error("E1125", last.span, fmt::format("the line ends in `{}`, so the next line continues it", last.text),
                         "complete the statement, or remove the operator or comma at the end of the line");
  out.secondary.push_back({next.span, "a statement begins here"});
  return out;
}

}  // namespace sysid::grammar::errors
