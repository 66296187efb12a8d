// Definitions of token.hpp. `lexeme` stands inside the rules: around them it would change the context type.
#pragma once
#include <charconv>
#include <string>

#include "grammar/actions.hpp"
#include "grammar/token.hpp"

namespace sysid::grammar {

/// The bytes of a raw[] part.
inline constexpr auto bytes = [](auto& context) {
  auto const& range = x3::_attr(context);
  return std::string_view(range.begin(), static_cast<std::size_t>(range.end() - range.begin()));
};

inline constexpr auto take_name = [](auto& context) {
  std::string_view const spelling = bytes(context);
  x3::_pass(context) = !words::contains(words::reserved, spelling);
  x3::_val(context).text = spelling;
};
/// `M[ 1,2 ]` is `M[1, 2]`.
inline constexpr auto take_element = [](auto& context) {
  std::string& text = x3::_val(context).text;
  for (char const each : bytes(context)) {
    if (each == ' ' || each == '\t') continue;
    text += each;
    if (each == ',') text += ' ';
  }
};
/// Correctly rounded, which X3's own real parsers are not.
inline constexpr auto take_value = [](auto& context) {
  std::string_view const digits = bytes(context);
  std::from_chars(digits.data(), digits.data() + digits.size(), x3::_val(context).value);
};
inline constexpr auto take_byte = [](auto& context) { x3::_val(context).value += x3::_attr(context); };
inline constexpr auto take_escape = [](auto& context) {
  x3::_val(context).value += x3::_attr(context) == 'n' ? '\n' : x3::_attr(context);
};

auto const name_def = located[x3::lexeme[x3::raw[name_begin >> *name_byte][take_name]]];
// `a..b` is a range: behind the dot of a path a name follows.
auto const path_def = located[x3::lexeme[x3::raw[name_begin >> *name_byte >> *('.' >> name_begin >> *name_byte)][take_name]]];
auto const blanks = *(x3::lit(' ') | '\t');
auto const whole = blanks >> +digit >> blanks;
auto const element_def = located[x3::lexeme[x3::raw[name_begin >> *name_byte >> *('.' >> name_begin >> *name_byte) >>
                                                    -('[' >> whole >> -(',' >> whole) >> ']')][take_element]]];
auto const text_def = located[x3::lexeme['"' >> *(('\\' >> x3::char_[take_escape]) | (x3::char_ - '"' - '\n')[take_byte]) >> '"']];
// The dot needs a digit behind it, so `1..500` is a range; `inf` and `nan` are names.
auto const fraction = '.' >> +digit;
auto const exponent_part = (x3::lit('e') | 'E') >> -(x3::lit('+') | '-') >> +digit;
auto const plain_number_def = located[x3::lexeme[x3::raw[+digit >> -fraction >> -exponent_part][take_value]]];
auto const equals_def = '=' >> !x3::lit('=');
auto const tilde_def = x3::lit('~');
auto const opening_brace_def = x3::lit('{');
auto const end_of_statement_def = &(x3::lit('\n') | ';' | '}' | x3::eoi);

BOOST_SPIRIT_DEFINE(name, path, element, text, plain_number, equals, tilde, opening_brace, end_of_statement)

}  // namespace sysid::grammar
