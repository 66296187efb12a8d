// Three passes over the tokens: match brackets, decide newlines, number statements.
#include "grammar/message/layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "grammar/message/errors.hpp"
#include "grammar/message/hints.hpp"
#include "syntax/words.hpp"

namespace sysid::grammar {

namespace {

/// A tree as deep as this is still safe to walk and destroy recursively; left-associated operators deepen it by one each.
constexpr int most_operators = 4000;

/// With those of other languages, so that a line goes on behind them and is refused once.
constexpr std::array<std::string_view, 21> binary_operators{
    "+", "-", "*", "/", "^", "<", "<=", ">", ">=", "==", "!=", "..", "or", "and", "...", "**", ".^", ".*", "./", "~=", "<>"};

bool is_binary_operator(Token const& token) {
  return token.kind != TokenKind::text && words::contains(binary_operators, token.text);
}

/// Words of statements behind which a value begins.
constexpr std::array<std::string_view, 5> before_values{"probability", "rows", "rate", "step", "with"};

char closer_of(char opener) { return opener == '(' ? ')' : opener == '[' ? ']' : '}'; }

class LayoutPass {
 public:
  LayoutPass(Source const& source, Scan scan) : source_(source), scan_(std::move(scan)), tokens_(scan_.tokens) {}

  Layout run(Diagnostics& diagnostics, std::size_t limit) {
    refuse_double_signs();
    match_brackets();
    decide_newlines();
    refuse_long_statements();
    report(diagnostics, limit);
    out_.tokens = std::move(scan_.tokens);
    out_.comments = std::move(scan_.comments);
    return std::move(out_);
  }

 private:
  void mistake(std::size_t token, Diagnostic diagnostic) { scan_.mistakes.push_back({token, std::move(diagnostic)}); }

  bool is_opener(std::size_t i) const { return tokens_[i].is("(") || tokens_[i].is("["); }

  /// An index stands directly behind its name.
  bool opens_index(std::vector<std::size_t> const& open) const {
    if (open.empty() || open.back() == 0) return false;
    Token const& before = tokens_[open.back() - 1];
    return before.kind == TokenKind::word && before.span.end == tokens_[open.back()].span.begin;
  }

  /// Inside brackets no declaration can stand: a line that begins like one means that the bracket was never closed.
  bool begins_declaration(std::size_t i) const {
    if (!tokens_[i].newline_before || tokens_[i].kind != TokenKind::word || i + 1 == tokens_.size()) return false;
    Token const& next = tokens_[i + 1];
    bool const word = words::contains(words::model_statements, tokens_[i].text) ||
                      words::contains(words::data_statements, tokens_[i].text) || words::contains(words::items, tokens_[i].text);
    return word && !next.newline_before && next.kind == TokenKind::word && !words::contains(words::reserved, next.text);
  }

  /// `(` and `[` still open when something comes that cannot stand inside them. One message for the outermost; all are forgotten.
  void close_unclosed(std::size_t found) {
    std::size_t outermost = tokens_.size();
    while (!open_.empty() && is_opener(open_.back())) {
      outermost = open_.back();
      open_.pop_back();
    }
    if (outermost < tokens_.size()) mistake(outermost, errors::unclosed(tokens_[outermost], found_here(found)));
  }

  Span found_here(std::size_t i) const {
    if (i < tokens_.size()) return tokens_[i].span;
    std::uint32_t const end = tokens_.empty() ? 0 : tokens_.back().span.end;
    return {end, end};
  }

  void match_brackets() {
    inside_.assign(tokens_.size() + 1, 0);
    for (std::size_t i = 0; i < tokens_.size(); ++i) {
      if (tokens_[i].newline_before) line_ = i;
      if (tokens_[i].kind == TokenKind::symbol)
        match_bracket(i);
      else if (begins_declaration(i))
        close_unclosed(i);
      // To the rules all that follows stands in the block.
      if (!open_.empty() && tokens_[open_.back()].is("{") && begins_task(i)) leave_block(i);
    }
    close_unclosed(tokens_.size());
    if (!open_.empty()) unclosed_block(open_.back(), tokens_.size());
    // inside_[i] counts the brackets around the gap before token i.
    for (std::size_t i = 1; i < inside_.size(); ++i) inside_[i] += inside_[i - 1];
  }

  void unclosed_block(std::size_t opener, std::size_t found) {
    Diagnostic unclosed = errors::unclosed(tokens_[opener], found_here(found));
    bool const block = found < tokens_.size() && words::contains(words::blocks, tokens_[found].text);
    if (block && braces_balance()) unclosed.help = errors::no_block_inside(tokens_[found]);
    mistake(opener, std::move(unclosed));
    if (found < tokens_.size()) spoilt_.push_back(found);
    out_.reported_at_end = true;
  }

  /// Then a block that begins inside another stands there on purpose.
  bool braces_balance() {
    auto const count = [&](std::string_view brace) {
      return std::count_if(tokens_.begin(), tokens_.end(), [&](Token const& each) { return each.is(brace); });
    };
    if (!balanced_) balanced_ = count("{") == count("}");
    return *balanced_;
  }

  void leave_block(std::size_t found) {
    unclosed_block(open_.front(), found);
    open_.clear();
    all_spoilt_from_ = std::min(all_spoilt_from_, found);
  }

  /// `fit duffing`, `posterior = fit duffing`: two words that no statement of a block may have there.
  bool begins_task(std::size_t i) const {
    std::size_t const verb = i + 1 < tokens_.size() && tokens_[i + 1].is("=") ? i + 2 : i;
    return tokens_[i].newline_before && tokens_[i].kind == TokenKind::word && verb + 1 < tokens_.size() &&
           words::contains(words::verbs, tokens_[verb].text) && tokens_[verb + 1].kind == TokenKind::word &&
           !tokens_[verb + 1].newline_before && !words::contains(words::reserved, tokens_[verb + 1].text) &&
           !(verb == i && tokens_[verb + 1].is("probability"));  // of a candidate with such a name
  }

  bool has_tilde(std::size_t before) const {
    for (std::size_t i = line_; i < before; ++i)
      if (tokens_[i].is("~")) return true;
    return false;
  }

  /// The `}` of the same line and not far away, or the number of tokens.
  std::size_t closing_brace(std::size_t opener) const {
    constexpr std::size_t far = 100;
    int depth = 0;
    for (std::size_t i = opener; i < std::min(tokens_.size(), opener + far) && (i == opener || !tokens_[i].newline_before); ++i) {
      depth += tokens_[i].is("{") ? 1 : tokens_[i].is("}") ? -1 : 0;
      if (depth == 0) return i;
      if (tokens_[i].is(";")) break;  // statements: a block
    }
    return tokens_.size();
  }

  /// Braces within one line that begins no block: `y^{3}`, `mh{samples = 100}`.
  bool stands_inside(std::size_t i) const {
    auto const begins = [&](std::size_t at) {
      if (at == 0 || tokens_[at].newline_before || tokens_[at - 1].is(";")) return true;
      return (tokens_[at - 1].is("{") || tokens_[at - 1].is("}")) && !inner_.contains(at - 1);
    };
    std::size_t first = i;
    while (!begins(first)) --first;
    if (first == i) return false;  // it may be the last token
    bool const in_block = std::any_of(open_.begin(), open_.end(), [&](std::size_t each) { return tokens_[each].is("{"); });
    bool const task = words::contains(words::verbs, tokens_[first].text) || tokens_[first + 1].is("=");
    return (in_block || task) && !words::contains(words::blocks, tokens_[first].text) && closing_brace(i) < tokens_.size();
  }

  std::string instead_of_brace(std::size_t i) const {
    std::size_t const close = closing_brace(i);
    std::string_view const inside =
        i + 1 < close
            ? std::string_view(tokens_[i + 1].text.data(), tokens_[close - 1].text.data() + tokens_[close - 1].text.size())
            : std::string_view();
    Token const &before = tokens_[i - 1], &first = tokens_[line_];
    if (i == line_ + 1 && !first.is("initial"))
      if (std::string block = instead_of_inner_block(first.text); !block.empty()) return block;
    bool const declares =
        first.is("parameter") || first.is("state") || first.is("input") || first.is("measure") || first.is("time");
    if (declares && before.is("="))
      return fmt::format("a range of values is written as a prior: {}", list_as_range(tokens_, i, close));
    if (declares && !before.is("^")) return fmt::format("a unit is written in brackets: `{} [{}]`", before.text, inside);
    if (first.is("function")) return fmt::format("a function is written with `=`: `= {}`", inside);
    if (words::contains(words::prepositions, before.text))
      return fmt::format("list the data without braces: `{} {}`", before.text, inside);
    bool const several = inside.find(',') != std::string_view::npos && tokens_[close - 1].kind != TokenKind::symbol;
    if (before.is("=") && several && !open_.empty() && tokens_[open_.back()].is("("))
      return fmt::format("write a list in parentheses: `({})`", inside);
    if (before.is("=") || before.is("initial")) return fmt::format("write it without braces: `{}`", inside);
    bool const calls = before.kind == TokenKind::word;
    return calls ? fmt::format("arguments stand in parentheses: `{}({})`", before.text, inside)
                 : fmt::format("write parentheses: `({})`", inside);
  }

  /// `20 +- 5`, `k*y -- a comment`: two signs behind a value that no blank holds apart.
  void refuse_double_signs() {
    for (std::size_t i = 1; i + 1 < tokens_.size(); ++i) {
      bool const signs = (tokens_[i].is("+") || tokens_[i].is("-")) && (tokens_[i + 1].is("+") || tokens_[i + 1].is("-"));
      Token const& before = tokens_[i - 1];
      bool const word = words::contains(words::reserved, before.text) || words::contains(before_values, before.text);
      bool const value = (before.kind != TokenKind::symbol && !word) || before.is(")") || before.is("]") || before.is("'");
      if (!signs || !value || tokens_[i].span.end != tokens_[i + 1].span.begin) continue;
      Span const both = cover(tokens_[i].span, tokens_[i + 1].span);
      std::string_view const written(tokens_[i].text.data(), 2);
      bool const numbers = before.kind == TokenKind::number && i + 2 < tokens_.size() && tokens_[i + 2].kind == TokenKind::number;
      mistake(
          i, errors::foreign_operator(
                 both, written,
                 written == "--"
                     ? "a comment begins with `#` or `//`; to subtract a negative number, write a space between the signs: `a - -b`"
                 : written == "++" ? "write a single `+`"
                 : numbers ? fmt::format("an uncertain value is a prior: `~ normal({}, sd = {})`", before.text, tokens_[i + 2].text)
                           : "an uncertain value is a prior, `~ normal(value, sd = 1)`; otherwise write a single sign"));
    }
  }

  void match_bracket(std::size_t i) {
    Token const& token = tokens_[i];
    if (is_opener(i)) {
      open_.push_back(i);
    } else if ((token.is("~") || token.is("=") || (token.is(",") && !opens_index(open_))) && !open_.empty() &&
               tokens_[open_.back()].is("[")) {
      // None of these stands in a unit.
      std::size_t const opener = open_.back();
      bool const closed = closing_on_line(tokens_, opener) < tokens_.size();
      bool const behind_word = closed && opener > 0 && tokens_[opener - 1].kind == TokenKind::word;
      bool const list =
          token.is(",") && opener > 0 && (is_opener(opener - 1) || continues_after(tokens_[opener - 1], true) || behind_word);
      bool const behind_prior = token.is(",") && opener > line_ + 2 && tokens_[line_].is("parameter") && !list && has_tilde(opener);
      bool const range = token.is(",") && opener > 0 && tokens_[opener - 1].is("in") && tokens_[line_].is("parameter");
      mistake(opener, range          ? errors::range_in_brackets(tokens_[opener].span)
                      : list         ? errors::list_in_brackets(tokens_[opener].span, instead_of_list(tokens_, line_, opener))
                      : behind_prior ? errors::bounds_in_brackets(tokens_[opener].span)
                                     : errors::unclosed(tokens_[opener], token.span));
      open_.pop_back();
      if (list && closed) {  // what follows `;` in it belongs to the same mistake
        ++inside_[opener + 1];
        --inside_[closing_on_line(tokens_, opener) + 1];
      }
    } else if (token.is("{") && stands_inside(i)) {
      mistake(i, errors::no_meaning(token.span, "`{`", instead_of_brace(i)));
      inner_.insert({i, closing_brace(i)});
    } else if (inner_.contains(i)) {
      return;  // closes one of these
    } else if (token.is("{")) {
      close_unclosed(i);
      // Blocks do not nest: a block that begins while another is open means that the other was never closed.
      if (!open_.empty() && words::contains(words::blocks, tokens_[line_].text)) leave_block(line_);
      open_.push_back(i);
    } else if (token.is("}")) {
      close_unclosed(i);
      if (!open_.empty()) open_.pop_back();
    } else if ((token.is(")") || token.is("]")) && !open_.empty() && is_opener(open_.back())) {
      std::size_t const opener = open_.back();
      open_.pop_back();
      if (closer_of(tokens_[opener].text[0]) != token.text[0]) mistake(i, errors::mismatched(tokens_[opener], token));
      ++inside_[opener + 1];
      --inside_[i + 1];
    }
  }

  bool continues_after(Token const& token, bool in_block) const {
    if (token.kind == TokenKind::text) return false;
    if (is_binary_operator(token) || token.is(",") || token.is("=") || token.is("~") || token.is("then") || token.is("else"))
      return true;
    return !in_block && (token.is("with") || words::contains(words::prepositions, token.text));
  }
  bool continues_before(std::size_t i, bool in_block) const {
    Token const& token = tokens_[i];
    bool const names_task = i + 1 < tokens_.size() && tokens_[i + 1].is("=");
    return is_binary_operator(token) || token.is("then") || token.is("else") || (!in_block && token.is("with") && !names_task);
  }

  /// A newline between these two, neighbours but for `;`, would not end a statement.
  bool joins(std::size_t before, std::size_t i, bool in_block) const {
    return !tokens_[i].is("}") && (inside_[i] > 0 || continues_after(tokens_[before], in_block) || continues_before(i, in_block));
  }

  /// `;` where a comma is meant: the statement goes on, so that one message is enough.
  bool ends_within_brackets(std::size_t i) const { return tokens_[i].is(";") && inside_[i] > 0; }

  /// `[0; 0]` is a list of other languages; elsewhere a comma is meant.
  void refuse_semicolon(std::size_t i) {
    std::size_t line = i, opener = i;
    while (line > 0 && !tokens_[line].newline_before) --line;
    int depth = 0;
    while (opener > line && !(depth == 0 && is_opener(opener))) {
      depth += tokens_[opener].is("]") || tokens_[opener].is(")") ? 1 : is_opener(opener) ? -1 : 0;
      --opener;
    }
    bool const list = tokens_[opener].is("[") && opener > line && closing_on_line(tokens_, opener) < tokens_.size() &&
                      (tokens_[opener - 1].kind == TokenKind::symbol || tokens_[opener - 1].is("initial"));
    if (list)
      mistake(opener, errors::list_in_brackets(tokens_[opener].span, instead_of_list(tokens_, line, opener)));
    else
      mistake(i, errors::semicolon_in_brackets(tokens_[i].span));
  }

  void decide_newlines() {
    out_.text = std::string(source_.text());
    auto const blank = [&](std::size_t begin, std::size_t end) {
      std::fill(out_.text.begin() + static_cast<std::ptrdiff_t>(begin), out_.text.begin() + static_cast<std::ptrdiff_t>(end), ' ');
    };
    for (Span const comment : scan_.comments) blank(comment.begin, comment.end);
    std::uint32_t end = 0;
    int statement = 0;
    bool in_block = false;
    std::size_t before = 0;  // one behind the last token that is no `;`
    for (std::size_t i = 0; i <= tokens_.size(); ++i) {
      std::uint32_t const begin = i < tokens_.size() ? tokens_[i].span.begin : static_cast<std::uint32_t>(out_.text.size());
      bool const both = i > 0 && i < tokens_.size();
      bool const separator = both && tokens_[i - 1].kind == TokenKind::symbol &&
                             std::string_view(";{}").find(tokens_[i - 1].text) != std::string_view::npos &&
                             !ends_within_brackets(i - 1) && !inner_.contains(i - 1);
      bool const joined = both && !separator && joins(i - 1, i, in_block);
      // Between tokens stand blanks and newlines only, once comments are gone.
      for (std::uint32_t at = end; at < begin; ++at)
        if (out_.text[at] != '\n' || joined) out_.text[at] = ' ';
      if (i == tokens_.size()) break;
      Token& token = tokens_[i];
      if (ends_within_brackets(i)) refuse_semicolon(i);
      if (separator || (token.newline_before && !joined) || (token.is("}") && !inner_.contains(i))) ++statement;
      token.statement = statement;
      token.joins_before =
          before > 0 && !tokens_[before - 1].is("{") && !tokens_[before - 1].is("}") && joins(before - 1, i, in_block);
      if ((token.is("{") || token.is("}")) && !inner_.contains(i)) in_block = token.is("{");
      end = token.span.end;
      if (!token.is(";")) before = i + 1;
    }
  }

  void refuse_long_statements() {
    for (std::size_t i = 0; i < tokens_.size();) {
      std::size_t const first = i;
      int operators = 0;
      for (; i < tokens_.size() && tokens_[i].statement == tokens_[first].statement; ++i)
        operators += is_binary_operator(tokens_[i]) || is_opener(i) || tokens_[i].is("not") || tokens_[i].is("if") ? 1 : 0;
      if (operators <= most_operators) continue;
      mistake(first, errors::statement_too_long(tokens_[first].span, most_operators));
      for (std::size_t j = first; j < i; ++j)
        if (tokens_[j].text.find_first_of("{};") == std::string_view::npos || tokens_[j].kind != TokenKind::symbol)
          std::fill(out_.text.begin() + tokens_[j].span.begin, out_.text.begin() + tokens_[j].span.end, ' ');
    }
  }

  void report(Diagnostics& diagnostics, std::size_t limit) {
    std::vector<Mistake*> in_order;  // places, which move at less cost than messages
    for (Mistake& mistake : scan_.mistakes) in_order.push_back(&mistake);
    std::stable_sort(in_order.begin(), in_order.end(), [](Mistake const* a, Mistake const* b) { return a->token < b->token; });
    for (Mistake* const each : in_order) {
      Mistake& mistake = *each;
      int const statement = tokens_.at(mistake.token).statement;
      if (out_.reported.insert(statement).second && diagnostics.all().size() < limit)
        diagnostics.add(std::move(mistake.diagnostic));
    }
    for (std::size_t const token : spoilt_) out_.reported.insert(tokens_[token].statement);
    for (std::size_t token = all_spoilt_from_; token < tokens_.size(); ++token) out_.reported.insert(tokens_[token].statement);
  }

  Source const& source_;
  Scan scan_;
  std::vector<Token>& tokens_;
  std::vector<std::size_t> open_, spoilt_;
  std::set<std::size_t> inner_;  // braces inside a statement, which are refused
  std::size_t all_spoilt_from_ = std::numeric_limits<std::size_t>::max();
  std::size_t line_ = 0;          // the first token of the line
  std::optional<bool> balanced_;  // as many braces open as close
  std::vector<int> inside_;
  Layout out_;
};

}  // namespace

std::size_t Layout::token_at(std::uint32_t offset) const {
  auto const found =
      std::partition_point(tokens.begin(), tokens.end(), [&](Token const& token) { return token.span.end <= offset; });
  return static_cast<std::size_t>(found - tokens.begin());
}

bool Layout::ends_line(std::uint32_t offset) const {
  std::size_t const at = text.find_first_not_of(' ', offset);
  return at == std::string::npos || text[at] == '\n';
}

Layout lay_out(Source const& source, Diagnostics& diagnostics, std::size_t limit) {
  return LayoutPass(source, scan(source.text())).run(diagnostics, limit);
}

}  // namespace sysid::grammar
