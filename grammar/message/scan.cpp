// Tokens by longest match, with the lexical mistakes met on the way.
#include "grammar/message/scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <span>
#include <utility>

#include "core/text/utf8.hpp"
#include "grammar/message/errors.hpp"
#include "syntax/words.hpp"

namespace sysid::grammar {

namespace {

/// Names of elements are made of it by the thousand, and primes make a state of each.
constexpr std::ptrdiff_t longest_word = 200;

constexpr std::array<std::string_view, 5> two_character_operators{"==", "!=", "<=", ">=", ".."};
constexpr std::string_view one_character_operators = "+-*/^<>=~,;(){}[].'%";

/// Length of the well-formed UTF-8 character that begins `text` (RFC 3629: no overlong forms, no surrogates), or 0.
std::size_t character_length(std::string_view text) {
  auto const byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  unsigned const lead = byte(0);
  if (lead < 0x80U) return 1;
  std::size_t const length = lead >= 0xC2U && lead <= 0xDFU   ? 2
                             : lead >= 0xE0U && lead <= 0xEFU ? 3
                             : lead >= 0xF0U && lead <= 0xF4U ? 4
                                                              : 0;
  if (length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if (!continues_character(text[i])) return 0;
  bool const overlong = (lead == 0xE0U && byte(1) < 0xA0U) || (lead == 0xF0U && byte(1) < 0x90U);
  bool const outside = (lead == 0xEDU && byte(1) > 0x9FU) || (lead == 0xF4U && byte(1) > 0x8FU);
  return overlong || outside ? 0 : length;
}

class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  Scan run() {
    if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;  // a byte order mark
    while (skip_blanks(), at_ < text_.size()) token();
    return std::move(out_);
  }

 private:
  char peek(std::size_t ahead = 0) const { return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0'; }
  bool follows(std::string_view what) const { return text_.substr(at_).starts_with(what); }
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }
  Span from(std::size_t begin) const { return {static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(at_)}; }
  void mistake(Diagnostic diagnostic) { out_.mistakes.push_back({out_.tokens.size(), std::move(diagnostic)}); }

  void skip_blanks() {
    newline_before_ = out_.tokens.empty();
    for (; at_ < text_.size(); ++at_) {
      if (peek() == '#' || follows("//")) {
        std::size_t const begin = at_;
        while (at_ < text_.size() && peek() != '\n') ++at_;
        out_.comments.push_back(from(begin));
        if (notation::includes_file(text_.substr(begin, at_ - begin))) include_ = from(begin);
      }
      if (peek() == '\n')
        newline_before_ = true;
      else if (!is_blank(peek()))
        return;
    }
  }

  void token() {
    std::size_t const begin = at_;
    if (include_)
      mistake(errors::no_meaning(*std::exchange(include_, std::nullopt), "`#include`",
                                 "`#` begins a comment: write `use NAME` for a module of the library or of this folder"));
    TokenKind kind = TokenKind::symbol;
    if (stands_for_primes()) {
      ++at_;
      mistake(errors::no_meaning(from(begin), "the character `\"`", "a second derivative is written with two primes: `y''`"));
    } else if (peek() == '"') {
      kind = TokenKind::text;
      text_token();
    } else if (words::is_digit(peek())) {
      kind = TokenKind::number;
      number_token();
    } else if (notation::LookAlike const* look_alike = find_look_alike()) {
      at_ += look_alike->bytes.size();
      mistake(errors::look_alike(from(begin), look_alike->bytes, look_alike->meant));
    } else if (is_superscript()) {
      superscript_token();
    } else if (words::begins_name(peek())) {
      kind = TokenKind::word;
      word_token();
    } else {
      symbol_token();
    }
    Span const span = from(begin);
    out_.tokens.push_back({kind, span, text_.substr(span.begin, span.end - span.begin), newline_before_});
  }

  notation::LookAlike const* find_look_alike() const { return notation::look_alike_at(text_.substr(at_)); }

  bool is_superscript() const { return notation::superscript_at(text_.substr(at_)) != nullptr; }

  /// `⁻³` as a power; `²` of `d²y/dt²` as that of a derivative.
  void superscript_token() {
    std::size_t const begin = at_;
    std::string power;
    while (notation::LookAlike const* row = notation::superscript_at(text_.substr(at_))) {
      power += row->meant;
      at_ += row->bytes.size();
    }
    bool const derivative =
        begin > 0 && text_[begin - 1] == 'd' && words::begins_name(peek()) && !out_.tokens.empty() && out_.tokens.back().is("d");
    mistake(errors::look_alike(from(begin), text_.substr(begin, at_ - begin),
                               derivative ? "derivatives with primes, `y''`" : fmt::format("`^{}`", power)));
  }

  /// `m*y" + k*y`: a quote directly behind a name that no text can follow, with nothing that begins a text behind it.
  bool stands_for_primes() const {
    if (peek() != '"' || out_.tokens.empty() || newline_before_ || out_.tokens.back().kind != TokenKind::word) return false;
    constexpr std::string_view behind = " \t\r\n+-*/^=,;)";
    bool const ends = at_ + 1 == text_.size() || behind.find(peek(1)) != std::string_view::npos;
    if (!ends || out_.tokens.back().span.end != at_) return false;
    std::size_t first = out_.tokens.size() - 1;
    while (first > 0 && !out_.tokens[first].newline_before) --first;
    std::string_view const word = out_.tokens[first].text;
    constexpr std::array<std::string_view, 4> declarations{"parameter", "state", "input", "constant"};
    bool const binds = std::any_of(out_.tokens.begin() + static_cast<std::ptrdiff_t>(first), out_.tokens.end(),
                                   [](Token const& each) { return each.is("=") || each.is("~"); });
    if (words::contains(declarations, word) && !binds) return false;  // `parameter m" mass"`
    return !words::contains(words::items, word) && !words::contains(words::data_statements, word);
  }

  void text_token() {
    std::size_t const begin = at_++;
    while (true) {
      if (at_ == text_.size() || peek() == '\n') {
        while (is_blank(text_[at_ - 1])) --at_;
        return mistake(errors::unclosed_text(from(begin)));
      }
      if (peek() == '"') {
        ++at_;
        return;
      }
      std::size_t const character = at_;
      std::size_t const length = character_length(text_.substr(at_));
      at_ += length == 0 ? 1 : length;
      if (length == 0 || (static_cast<unsigned char>(text_[character]) < 0x20U && text_[character] != '\t'))
        mistake(errors::stray_byte(from(character), static_cast<unsigned char>(text_[character])));
      if (text_[character] == '\\' && at_ < text_.size() && peek() != '\n') {
        char const escaped = text_[at_];
        ++at_;
        if (escaped != '"' && escaped != '\\' && escaped != 'n') {
          while (at_ < text_.size() && continues_character(peek())) ++at_;
          mistake(errors::unknown_escape(from(character), text_.substr(character, at_ - character)));
        }
      }
    }
  }

  void digits() {
    while (words::is_digit(peek())) ++at_;
  }

  void number_token() {
    std::size_t const begin = at_;
    digits();
    if (peek() == '.' && words::is_digit(peek(1))) {
      ++at_;
      digits();
    }
    if (peek() == 'e' || peek() == 'E') {
      std::size_t const sign = peek(1) == '+' || peek(1) == '-' ? 1 : 0;
      if (words::is_digit(peek(1 + sign))) {
        at_ += 1 + sign;
        digits();
      }
    }
    if (fortran_exponent(begin)) return;
    std::string_view const number = text_.substr(begin, at_ - begin);
    double value = 0;
    if (std::from_chars(number.data(), number.data() + number.size(), value).ec == std::errc::result_out_of_range)
      mistake(errors::number_out_of_range(from(begin), number));
    if (peek() == '.' && peek(1) != '.') {
      ++at_;
      if (words::is_digit(peek())) {
        digits();
        return mistake(errors::second_dot(from(begin), text_.substr(begin, at_ - begin)));
      }
      mistake(errors::dot_without_digits(from(begin), text_.substr(begin, at_ - begin), with_digits_behind(number)));
    }
  }

  /// `1d-3`, `1.5D3`: with what follows, it is one number to whoever wrote it.
  bool fortran_exponent(std::size_t begin) {
    if (peek() != 'd' && peek() != 'D') return false;
    std::size_t const sign = peek(1) == '+' || peek(1) == '-' ? 1 : 0;
    if (!words::is_digit(peek(1 + sign))) return false;
    std::size_t const letter = at_;
    at_ += 1 + sign;
    digits();
    if (words::continues_name(peek())) {  // `2d3x` is a product with a name
      at_ = letter;
      return false;
    }
    mistake(errors::fortran_exponent(from(begin), text_.substr(begin, letter - begin), text_.substr(letter, at_ - letter)));
    return true;
  }

  static std::string with_digits_behind(std::string_view number) {
    return number.find_first_of(".eE") == std::string_view::npos ? std::string(number) + ".0" : std::string(number);
  }

  void word_token() {
    std::size_t const begin = at_;
    word_characters();
    auto const length =
        std::count_if(text_.begin() + static_cast<std::ptrdiff_t>(begin), text_.begin() + static_cast<std::ptrdiff_t>(at_),
                      [](char c) { return !continues_character(c); });
    if (length > longest_word) mistake(errors::word_too_long(from(begin), longest_word));
  }

  void word_characters() {
    while (at_ < text_.size() && words::continues_name(peek())) {
      if (find_look_alike() != nullptr || is_superscript()) return;
      std::size_t const character = at_;
      std::size_t const length = character_length(text_.substr(at_));
      at_ += length == 0 ? 1 : length;
      if (length == 0) mistake(errors::stray_byte(from(character), static_cast<unsigned char>(text_[character])));
    }
    while (peek() == '\'') ++at_;
  }

  void symbol_token() {
    std::size_t const begin = at_;
    if (peek() == '\\') return latex_command();
    if (peek() == ':' && peek(1) != '=') return colon();
    if (follows("...") && ends_number() && words::is_digit(peek(3))) return three_dots();
    if (peek() == '!' && peek(1) != '=' && ends_value()) {
      ++at_;
      return mistake(errors::foreign_operator(from(begin), "!", "a comment begins with `#` or `//`"));
    }
    if (notation::Operator const* const foreign = notation::operator_at(text_.substr(at_))) {
      at_ += foreign->symbol.size();
      return mistake(errors::foreign_operator(from(begin), foreign->symbol, foreign->help));
    }
    for (std::string_view const symbol : two_character_operators) {
      if (follows(symbol)) {
        at_ += symbol.size();
        return;
      }
    }
    if (peek() == '?' && !newline_before_ && out_.tokens.size() >= 2 && out_.tokens.back().is("=")) {
      ++at_;
      return mistake(errors::no_meaning(from(begin), "the character `?`", notation::instead_of_unknown(out_.tokens)));
    }
    char const symbol = text_[at_++];
    if (symbol == '.' && words::is_digit(peek())) {
      bool const after_operand = begin > 0 && (words::continues_name(text_[begin - 1]) || text_[begin - 1] == '\'');
      digits();
      if (!after_operand)
        mistake(errors::dot_without_digits(from(begin), text_.substr(begin, at_ - begin),
                                           "0" + std::string(text_.substr(begin, at_ - begin))));
    } else if (one_character_operators.find(symbol) == std::string_view::npos) {
      mistake(errors::stray_byte(from(begin), static_cast<unsigned char>(symbol)));
    }
  }

  bool ends_number() const { return !out_.tokens.empty() && !newline_before_ && out_.tokens.back().kind == TokenKind::number; }
  bool ends_value() const {
    return !out_.tokens.empty() && !newline_before_ &&
           (out_.tokens.back().kind != TokenKind::symbol || out_.tokens.back().is(")") || out_.tokens.back().is("]"));
  }

  void three_dots() {
    std::size_t const begin = at_, digits_from = at_ + 3;
    std::size_t end = digits_from;
    while (end < text_.size() && words::is_digit(text_[end])) ++end;
    at_ += 3;
    mistake(errors::foreign_operator(from(begin), "...",
                                     fmt::format("a range is written with two dots: `{}..{}`", out_.tokens.back().text,
                                                 text_.substr(digits_from, end - digits_from))));
  }

  /// `\ddot{y}`: with its name it is one character without meaning.
  void latex_command() {
    std::size_t const begin = at_++;
    std::size_t const name = at_;
    while ((peek() >= 'a' && peek() <= 'z') || (peek() >= 'A' && peek() <= 'Z')) ++at_;
    std::string_view const command = text_.substr(name, at_ - name);
    bool const behind_name = begin > 0 && words::continues_name(text_[begin - 1]);
    if (command.empty() || (behind_name && !notation::is_command(command))) {
      at_ = name;  // `N\m`
      std::size_t const next = text_.find_first_not_of(" \t", at_);
      if (next == std::string_view::npos || text_[next] == '\n' || text_[next] == '\r')
        return mistake(
            errors::no_meaning(from(begin), "the character `\\`",
                               "remove it: a line ends inside parentheses, or after an operator or a comma, and goes on"));
      if (peek() == '(')
        return mistake(
            errors::no_meaning(from(begin), "the character `\\`",
                               "`a\\b` of matrices is the solution of an equation; of numbers it is the quotient `b/a`"));
      return mistake(errors::no_meaning(from(begin), "the character `\\`", "a quotient is written with `/`"));
    }
    mistake(errors::no_meaning(from(begin), fmt::format("the command `{}` of LaTeX", text_.substr(begin, at_ - begin)),
                               notation::instead_of_command(command)));
  }

  /// A colon, by what stands before it.
  void colon() {
    std::size_t const begin = at_;
    ++at_;
    if (peek() == ':') ++at_;
    mistake(errors::no_meaning(from(begin), fmt::format("the character `{}`", text_.substr(begin, at_ - begin)),
                               notation::instead_of_colon(text_, begin, at_, newline_before_, out_.tokens)));
  }

  std::string_view text_;
  std::size_t at_ = 0;
  bool newline_before_ = false;
  std::optional<Span> include_;  // a comment that is none to whoever wrote it
  Scan out_;
};

}  // namespace

Scan scan(std::string_view text) { return Scanner(text).run(); }

}  // namespace sysid::grammar
