// Detection of the usual mistakes from the tokens around a failure. The wording is in errors.cpp.
#include "grammar/message/explain.hpp"

#include <fmt/format.h>

#include "grammar/message/errors.hpp"
#include "grammar/message/hints.hpp"
#include "syntax/foreign_words.hpp"
#include "syntax/words.hpp"

namespace sysid::grammar {

namespace {

constexpr std::array<std::string_view, 6> comparisons{"<", "<=", ">", ">=", "==", "!="};
/// Messages of many causes, whose help a hint may replace.
constexpr std::array<std::string_view, 5> general{"E1105", "E1113", "E1114", "E1118", "E1121"};
constexpr std::array<std::string_view, 9> unfinished{"+", "-", "*", "/", "^", ",", "=", "~", ".."};

bool is_symbol(Token const& token, std::span<std::string_view const> table) {
  return token.kind == TokenKind::symbol && words::contains(table, token.text);
}
bool is_word(Token const& token) { return token.kind == TokenKind::word; }
bool is_reserved(Token const& token) { return is_word(token) && words::contains(words::reserved, token.text); }
bool ends_value(Token const& token) {
  return (token.kind != TokenKind::symbol && !is_reserved(token)) || token.is(")") || token.is("]") || token.is("'");
}

/// The tokens around one failure.
class Failure {
 public:
  Failure(Layout const& layout, std::uint32_t where, std::string const& wanted)
      : tokens_(layout.tokens), wanted_(wanted), at_end_(layout.ends_line(where)), found_(layout.token_at(where)) {
    // A closing brace counts as a statement of its own, but what fails there is what stands before it.
    bool const before = at_end_ || found().is("}");
    std::size_t const here = before && found_ > 0 ? found_ - 1 : std::min(found_, tokens_.size() - 1);
    statement_ = tokens_.empty() ? 0 : tokens_[here].statement;
    first_ = std::min(found_, tokens_.size());
    while (first_ > 0 && tokens_[first_ - 1].statement == statement_) --first_;
  }

  int statement() const { return statement_; }
  bool at_end_of_file() const { return at_end_ && found_ == tokens_.size(); }

  Diagnostic diagnostic() const {
    if (wanted_ == wanted::shallower_nesting) return errors::nesting_too_deep(span(), deepest_nesting);
    if (auto incomplete = unfinished_line()) return *incomplete;
    if (!at_end_ && found().is("=") && wanted_ == wanted::equals) return one_side();
    auto specific = at_end_ ? at_end() : at_token();
    std::string const help = hint(gap());
    if (specific && !help.empty() && words::contains(general, specific->code)) specific->help = help;
    if (specific) return *specific;
    std::string const guess = misspelt();
    return errors::expected(span(), noun_phrase(), found_phrase(), guess.empty() ? help : guess);
  }

 private:
  Token const& found() const { return tokens_[found_]; }
  Token const* previous(std::size_t steps = 1) const {
    return found_ >= steps && tokens_[found_ - steps].statement == statement_ ? &tokens_[found_ - steps] : nullptr;
  }
  Token const* next() const {
    return found_ + 1 < tokens_.size() && tokens_[found_ + 1].statement == statement_ ? &tokens_[found_ + 1] : nullptr;
  }
  Token const* first() const {
    return first_ < tokens_.size() && tokens_[first_].statement == statement_ ? &tokens_[first_] : nullptr;
  }
  bool begins_with(std::string_view keyword) const { return first() != nullptr && first()->is(keyword); }

  Gap gap() const {
    std::size_t last = first_;
    while (last < tokens_.size() && tokens_[last].statement == statement_) ++last;
    return {wanted_,
            at_end_ || found_ == tokens_.size() ? nullptr : &found(),
            {tokens_.data() + first_, last - first_},
            found_ - first_,
            wanted_ == wanted::operator_between ? declared_names() : std::vector<std::string_view>()};
  }

  /// Words behind a keyword that declares, and those in the list that it begins; of all models of the file.
  std::vector<std::string_view> declared_names() const {
    std::vector<std::string_view> names;
    for (std::size_t i = 0; i + 1 < tokens_.size(); ++i) {
      bool const begins = i == 0 || tokens_[i - 1].statement != tokens_[i].statement;
      if (!begins || !words::contains(words::model_statements, tokens_[i].text)) continue;
      for (std::size_t at = i + 1; at < tokens_.size() && tokens_[at].statement == tokens_[i].statement; ++at)
        if (is_word(tokens_[at]) && (at == i + 1 || tokens_[at - 1].is(","))) names.push_back(tokens_[at].text);
    }
    return names;
  }

  /// At a word that begins an item: the name behind it is what is missing.
  Gap name_missing() const {
    Gap gap = this->gap();
    return {wanted::name, next(), gap.statement, gap.at + 1, {}};
  }

  Span span() const {
    if (!at_end_) return found().span;
    std::uint32_t const end = found_ == 0 ? 0 : tokens_[found_ - 1].span.end;
    return {end, end};
  }

  /// The rules' names are noun phrases already; a literal is named 'x' by X3.
  std::string noun_phrase() const {
    return wanted_.size() == 3 && wanted_.front() == '\'' ? fmt::format("`{}`", wanted_[1]) : wanted_;
  }

  /// "did you mean ...": the words in quotes of what was wanted, and `hold` where a data input may go on.
  std::string misspelt() const {
    if (at_end_ || !is_word(found())) return {};
    std::vector<std::string> known;
    for (std::size_t begin = wanted_.find('`'); begin != std::string::npos; begin = wanted_.find('`', begin)) {
      std::size_t const end = wanted_.find('`', begin + 1);
      if (end == std::string::npos) break;
      known.push_back(wanted_.substr(begin + 1, end - begin - 1));
      begin = end + 1;
    }
    if (wanted_ == wanted::end_of_statement && begins_with("input")) known.emplace_back("hold");
    return did_you_mean(found().text, known);
  }

  std::string found_phrase() const {
    if (at_end_) return at_end_of_file() ? "the end of the file" : "the end of the line";
    switch (found().kind) {
      case TokenKind::number:
        return fmt::format("the number `{}`", found().text);
      case TokenKind::text:
        return "a text";
      case TokenKind::word:
      case TokenKind::symbol:
        break;
    }
    return fmt::format("`{}`", found().text);
  }

  /// `... +` and on the next line `parameter c ~ ...`: the rules see `+ parameter c`.
  std::optional<Diagnostic> unfinished_line() const {
    if (at_end_ || !is_word(found()) || found().newline_before) return std::nullopt;
    if (auto task = comma_before_task()) return task;
    Token const* const keyword = previous();
    Token const* const last = previous(2);
    if (keyword == nullptr || last == nullptr || !keyword->newline_before || !is_symbol(*last, unfinished)) return std::nullopt;
    if (!words::contains(words::model_statements, keyword->text) && !words::contains(words::data_statements, keyword->text) &&
        !words::contains(words::items, keyword->text))
      return std::nullopt;
    return errors::statement_incomplete(*last, *keyword);
  }

  /// `k =`, `= 3`.
  Diagnostic one_side() const {
    std::string const help = "an equation has two sides: `left = right`";
    if (found_ == first_) return errors::expected(span(), wanted::value, found_phrase(), help);
    Token const* const behind = next();
    std::uint32_t const end = found().span.end;
    return behind == nullptr ? errors::expected({end, end}, wanted::value, "the end of the line", help)
                             : errors::expected(behind->span, wanted::value, fmt::format("`{}`", behind->text), help);
  }

  /// `seed = 1,` and on the next line `forecast = predict ...`.
  std::optional<Diagnostic> comma_before_task() const {
    Token const *verb = previous(), *sign = previous(2), *name = previous(3), *comma = previous(4);
    bool const task = comma != nullptr && comma->is(",") && name->newline_before && is_word(*name) && sign->is("=") &&
                      words::contains(words::verbs, verb->text);
    return task ? std::optional(errors::statement_incomplete(*comma, *name)) : std::nullopt;
  }

  std::optional<Diagnostic> at_end() const {
    if (wanted_ != wanted::equals) return std::nullopt;
    if (found_ == first_ + 1 && is_word(tokens_[first_]) && in_model())
      return errors::unknown_statement(tokens_[first_], "a model", words::model_statements);
    for (std::size_t i = first_; i + 1 < found_; ++i)
      if (tokens_[i].is("<") && tokens_[i + 1].is("-") && tokens_[i].span.end == tokens_[i + 1].span.begin)
        return errors::left_arrow(cover(tokens_[i].span, tokens_[i + 1].span));
    for (std::size_t i = first_; i < found_; ++i)
      if (tokens_[i].is("==")) return errors::double_equals(tokens_[i].span);
    return std::nullopt;
  }

  /// `1'000'000` without its primes; empty for all else.
  std::string grouped_by_primes() const {
    if (previous() == nullptr || previous()->kind != TokenKind::number) return {};
    std::string number(previous()->text);
    std::size_t end = previous()->span.end;
    for (std::size_t i = found_; i + 1 < tokens_.size() && tokens_[i].is("'") && tokens_[i].span.begin == end; i += 2) {
      Token const& group = tokens_[i + 1];
      if (group.kind != TokenKind::number || group.span.begin != end + 1 || group.text.substr(0, 3).find('.') != group.text.npos ||
          group.text.size() < 3)
        return {};
      number += group.text;
      end = group.span.end;
    }
    return end > previous()->span.end ? number : std::string();
  }

  std::optional<Diagnostic> at_token() const {
    bool const value_before = previous() != nullptr && ends_value(*previous());
    bool const wants_name = wanted_ == wanted::name || wanted_ == wanted::column;
    if (found().is("'")) return errors::prime_apart(found().span, grouped_by_primes());
    bool const keyword = first() != nullptr && words::contains(words::model_statements, first()->text);
    if (found().is("[") && previous() != nullptr && is_word(*previous()) && found_ == first_ + 1 && has("~") && !keyword)
      return errors::tilde_without_keyword(found().span);
    bool const column = found().is("[") && wanted_ == wanted::equals && (begins_with("measure") || begins_with("input"));
    if (found().is("[") && value_before && !wanted_.starts_with("a ") && !column) return errors::bracket_out_of_place(found().span);
    if (is_reserved(found()) && wants_name) return errors::reserved_word(found());
    if (found().is("<") && wanted_ == wanted::equals && next() != nullptr && next()->is("-") &&
        next()->span.begin == found().span.end)
      return errors::left_arrow(cover(found().span, next()->span));
    if (is_symbol(found(), comparisons)) return at_comparison();
    if (wanted_ == wanted::operator_between && previous() != nullptr) return side_by_side();
    if (found().is("=") && wanted_ == wanted::end_of_statement) return second_equals();
    bool const channels = found().is(",") || found().is("and");
    if (begins_with("observe") && wanted_ == wanted::tilde && !channels)
      return errors::tilde_missing(span(), "observe", with_tilde());
    bool const prior_missing = begins_with("parameter") && !has("~") && wanted_ == wanted::end_of_statement;
    if (prior_missing && is_word(found()) && value_before && unit_here().empty())
      return errors::tilde_missing(span(), "parameter", with_tilde());
    if (found().is("~") && value_before && !begins_with("parameter") &&
        (wanted_ == wanted::equals || wanted_ == wanted::end_of_statement))
      return errors::tilde_without_keyword(found().span);
    if ((found().is("+") || found().is("-")) && wanted_ == wanted::model_statement) return errors::begins_with_sign(found());
    if (!is_word(found())) return std::nullopt;
    if (wanted_ == wanted::data_statement) return unknown_data_statement();
    if (wanted_ == wanted::dictionary_statement) return unknown_dictionary_statement();
    if (wanted_ == wanted::item && words::contains(words::items, found().text) && next() != nullptr)
      return errors::expected(next()->span, wanted::name, fmt::format("`{}`", next()->text), hint(name_missing()));
    if (wanted_ == wanted::item) return unknown_item();
    if (wanted_ == wanted::verb) return unknown_verb();
    return std::nullopt;
  }

  /// `set k = 3 [N/m]`.
  std::string value_in_declaration() const {
    Gap const here = gap();
    std::size_t const equals = here.find("="), unit = here.find("[", equals);
    std::string const number(here.text(equals + 1, unit));
    if (number.empty() || unit + 1 < here.statement.size())
      return fmt::format("a value is given in the declaration: `parameter {} {} = {}`", here.statement[1].text,
                         here.text(unit, here.statement.size()), number.empty() ? "1" : number);
    return fmt::format("a value is given in the declaration, with the unit behind the name: `parameter {} = {}`",
                       here.statement[1].text, number);
  }

  Diagnostic unknown_model_statement(Token const& word) const {
    Diagnostic diagnostic = errors::unknown_statement(word, "a model", words::model_statements);
    bool const typed = words::translated(words::foreign_model_statements(), word.text) == "let";
    if (words::contains(words::items, word.text)) diagnostic.help = fmt::format("`{}` stands outside of models", word.text);
    if (word.is("set") && has("=")) diagnostic.help = value_in_declaration();
    if (typed && has("~")) diagnostic.help = "did you mean `parameter`?";
    if (typed && !has("~") && !has("=")) diagnostic.help = "did you mean `state`, or `parameter` for a value to be estimated?";
    return diagnostic;
  }

  Diagnostic unknown_dictionary_statement() const {
    Diagnostic diagnostic = errors::unknown_statement(found(), "a dictionary", words::dictionary_statements);
    if (found().is("disturbance"))
      diagnostic.help =
          "a dictionary cannot contain a disturbance: remove it, and declare it in the model that is fitted afterwards";
    return diagnostic;
  }

  Diagnostic unknown_data_statement() const {
    Diagnostic diagnostic = errors::unknown_statement(found(), "a data block", words::data_statements);
    if (found().is("hold")) diagnostic.help = "the rule comes after the column of its input: `input x = force [N] hold linear`";
    if (has(".."))
      diagnostic.help = fmt::format("a range of rows has a name: `split {}{}`", has("=") ? "" : "train = ", gap().rest());
    if (std::string const meant = instead_of_data_statement(gap()); !meant.empty()) diagnostic.help = meant;
    if (std::string place = errors::place_of_statement(found().text, has("~")); !place.empty()) diagnostic.help = std::move(place);
    return diagnostic;
  }

  Diagnostic unknown_item() const {
    Diagnostic diagnostic = errors::unknown_item(found());
    Token const* const sign = next();
    Token const* const verb = next_but_one();
    if (sign != nullptr && verb != nullptr && sign->is("<") && verb->is("-") && sign->span.end == verb->span.begin) {
      diagnostic = errors::left_arrow(cover(sign->span, verb->span));
      Token const* const task =
          found_ + 3 < tokens_.size() && verb->statement == tokens_[found_ + 3].statement ? &tokens_[found_ + 3] : nullptr;
      diagnostic.help =
          fmt::format("the name of a task is followed by `=`: `{} = {}`", found().text, task == nullptr ? "fit ..." : task->text);
      return diagnostic;
    }
    if (sign != nullptr && verb != nullptr && sign->is("~") && words::contains(words::verbs, verb->text))
      diagnostic.help = fmt::format("the name of a task is followed by `=`: `{} = {}`", found().text, verb->text);
    bool const of_model = words::contains(words::model_statements, found().text),
               of_data = words::contains(words::data_statements, found().text);
    if (of_model || of_data)
      diagnostic.help = fmt::format("`{}` belongs in a {}: move this line there", found().text, of_model ? "model" : "data block");
    bool const task_behind = found_ + 3 < tokens_.size() && words::contains(words::verbs, tokens_[found_ + 3].text);
    if (verb != nullptr && verb->is("=") && of_model && task_behind)
      diagnostic.help = fmt::format("outside a block, a task is written `NAME = fit ...`: remove `{}`", found().text);
    bool const named = sign != nullptr && verb != nullptr && !words::contains(words::model_statements, found().text);
    Token const* const equals =
        found_ + 3 < tokens_.size() && tokens_[found_ + 3].statement == statement_ ? &tokens_[found_ + 3] : nullptr;
    if (named && is_word(*sign) && verb->is("="))
      diagnostic.help = fmt::format("a name is one word: `{}_{} = ...`", found().text, sign->text);
    if (named && (sign->is("-") || sign->is(".")) && equals != nullptr && equals->is("="))
      diagnostic.help = fmt::format("a name is made of letters, digits and `_`: `{}_{} = ...`", found().text, verb->text);
    if (std::string const place = errors::place_of_output(found().text); !place.empty()) diagnostic.help = place;
    bool const module = words::translated(words::foreign_items(), found().text) == "use";
    if (module && sign != nullptr && is_word(*sign))
      diagnostic.help = fmt::format(
          "write `use {}` if it is a module of the library or of this folder; functions such as `sqrt` need no `use`", sign->text);
    return diagnostic;
  }

  Diagnostic unknown_verb() const {
    Diagnostic diagnostic = errors::unknown_verb(found());
    bool const behind_semicolon =
        first_ > 1 && tokens_[first_ - 1].is(";") && found_ == first_ + 2 && !tokens_[first_].newline_before;
    if (std::string const place = errors::place_of_output(found().text); !place.empty()) diagnostic.help = place;
    if (behind_semicolon) diagnostic.help = "options of a task are separated by commas: write `,` in place of `;`";
    return diagnostic;
  }

  Token const* next_but_one() const {
    return found_ + 2 < tokens_.size() && tokens_[found_ + 2].statement == statement_ ? &tokens_[found_ + 2] : nullptr;
  }

  bool has(std::string_view symbol) const {
    for (std::size_t i = first_; i < tokens_.size() && tokens_[i].statement == statement_; ++i)
      if (tokens_[i].is(symbol)) return true;
    return false;
  }

  std::string unit_here() const { return unit_without_brackets(gap()); }

  /// `parameter m [kg] ~ normal(...)` of `parameter m [kg] normal(0, sd = 1)`, `observe y ~ normal(...)` of `observe y =
  /// normal(...)`.
  std::string with_tilde() const {
    std::size_t const distribution = found().is("=") ? found_ + 1 : found_;
    bool const call = distribution + 1 < tokens_.size() && is_word(tokens_[distribution]) && tokens_[distribution + 1].is("(") &&
                      tokens_[distribution + 1].statement == statement_;
    return call ? fmt::format("{} ~ {}(...)", written(tokens_[first_], *previous()), tokens_[distribution].text) : std::string();
  }

  /// `k*y =` and on the next line `m*y'' = x`: one statement with two `=`.
  std::optional<Diagnostic> second_equals() const {
    for (std::size_t i = found_; i-- > first_;)
      if (tokens_[i + 1].newline_before && is_symbol(tokens_[i], unfinished))
        return errors::statement_incomplete(tokens_[i], tokens_[i + 1]);
    for (std::size_t i = found_; i-- > first_;)
      if (tokens_[i].newline_before && i > first_ && (tokens_[i].is("-") || tokens_[i].is("+")))
        return errors::begins_with_sign(tokens_[i]);
    return std::nullopt;
  }

  std::optional<Diagnostic> at_comparison() const {
    int depth = 0;
    for (std::size_t i = found_; i-- > first_ && depth >= 0;) {
      depth += tokens_[i].is(")") ? 1 : tokens_[i].is("(") ? -1 : 0;
      if (depth == 0 && (tokens_[i].is(",") || tokens_[i].is("="))) break;
      if (depth == 0 && is_symbol(tokens_[i], comparisons)) return errors::chained_comparison(tokens_[i], found());
    }
    if (found().is("==")) return errors::double_equals(found().span);
    return std::nullopt;
  }

  /// Two values without an operator: a misspelt keyword at the start of a statement, else a product as on paper.
  std::optional<Diagnostic> side_by_side() const {
    Token const& word = *previous();
    if (found_ - 1 == first_ && is_word(word) && in_model()) {
      bool equation = false;
      for (std::size_t i = found_; i < tokens_.size() && tokens_[i].statement == statement_; ++i) equation |= tokens_[i].is("=");
      bool const declares = next() != nullptr && (next()->is("[") || next()->is("~"));
      bool const foreign = !words::translated(words::foreign_model_statements(), word.text).empty();
      if (word.is("equation") || word.is("eq") || word.is("ode")) return errors::equation_with_keyword(word);
      if (!equation || declares || foreign || !nearest(word.text, words::list(words::model_statements)).empty())
        return unknown_model_statement(word);
    }
    if (begins_task()) return errors::two_tasks_on_a_line(found());
    if (names_argument()) {
      Diagnostic missing = errors::comma_missing(word, found());
      std::string const settings = previous(2) != nullptr && previous(2)->is("with") ? hint(gap()) : std::string();
      if (!settings.empty()) missing.help = settings;
      return missing;
    }
    Gap const here = gap();
    std::string const instead = instead_of_product(here);
    Diagnostic missing = errors::no_operator_between(word, found(), instead);
    // A factor that the file does not declare would be refused next.
    bool const no_factor = word.kind == TokenKind::number && is_word(found()) && !here.declares(found().text);
    if (no_factor && !instead.empty()) missing.help = instead;
    return missing;
  }

  /// `seed = 1 forecast = predict ...`: behind the options of a task.
  bool begins_task() const {
    if (found_ + 2 >= tokens_.size() || !is_word(found()) || !tokens_[found_ + 1].is("=")) return false;
    int depth = 0;
    bool options = false;
    for (std::size_t i = first_; i < found_; ++i) {
      depth += tokens_[i].is("(") ? 1 : tokens_[i].is(")") ? -1 : 0;
      options = options || tokens_[i].is("with");
    }
    return depth == 0 && options && words::contains(words::verbs, tokens_[found_ + 2].text);
  }

  /// `mh(samples = 100) seed = 1`, `normal(y sd = 1)`: named things in a list, which begins in brackets or behind `with`.
  bool names_argument() const {
    std::size_t const name = found().is("input") ? found_ + 1 : found_;
    bool const named = name + 1 < tokens_.size() && is_word(tokens_[name]) && tokens_[name + 1].is("=") &&
                       tokens_[name + 1].statement == statement_;
    int depth = 0;
    for (std::size_t i = first_; i < found_; ++i)
      depth += tokens_[i].is("(") ? 1 : tokens_[i].is(")") ? -1 : tokens_[i].is("with") ? 1 : 0;
    return named && (depth > 0 || begins_with("initial"));
  }

  bool in_model() const {
    std::size_t i = first_;
    while (i > 0 && !tokens_[i].is("{") && !tokens_[i].is("}")) --i;
    if (!tokens_[i].is("{")) return false;
    int const header = tokens_[i].statement;
    while (i > 0 && tokens_[i - 1].statement == header) --i;
    return tokens_[i].is("model");
  }

  std::vector<Token> const& tokens_;
  std::string const& wanted_;
  bool at_end_;
  std::size_t found_;
  std::size_t first_ = 0;
  int statement_ = 0;
};

}  // namespace

std::optional<Diagnostic> explain(Layout const& layout, std::uint32_t where, std::string const& wanted) {
  Failure const failure(layout, where, wanted);
  if (layout.reported.contains(failure.statement()) || (failure.at_end_of_file() && layout.reported_at_end)) return std::nullopt;
  return failure.diagnostic();
}

}  // namespace sysid::grammar
