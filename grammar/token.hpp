// Names, texts, numbers, and the marks that more than one group of rules needs.
#pragma once
#include "grammar/context.hpp"
#include "syntax/ast.hpp"
#include "syntax/words.hpp"

namespace sysid::grammar {

inline constexpr x3::rule<struct name_tag, ast::Name> name = wanted::name;
/// A name behind those of the parts it lies in: `spring.force`.
inline constexpr x3::rule<struct path_tag, ast::Name> path = wanted::name;
/// A number that is declared under a path, perhaps as an element of a vector or matrix: `spring.k`, `q[2]`, `M[1, 2]`.
inline constexpr x3::rule<struct element_tag, ast::Name> element = wanted::name;
inline constexpr x3::rule<struct text_tag, ast::Text> text = "a text in quotes";
/// Without a unit.
inline constexpr x3::rule<struct plain_number_tag, ast::Number> plain_number = "a number";
inline constexpr x3::rule<struct equals_tag> equals = wanted::equals;
inline constexpr x3::rule<struct tilde_tag> tilde = wanted::tilde;
inline constexpr x3::rule<struct opening_brace_tag> opening_brace = wanted::opening_brace;
inline constexpr x3::rule<struct end_of_statement_tag> end_of_statement = wanted::end_of_statement;

BOOST_SPIRIT_DECLARE(decltype(name), decltype(path), decltype(element), decltype(text), decltype(plain_number), decltype(equals),
                     decltype(tilde), decltype(opening_brace), decltype(end_of_statement))

/// One byte of a class, by the language's own tables: X3's character classes abort on UTF-8 or depend on the signedness of char.
template <bool (*Test)(char)>
struct byte_class : x3::char_parser<byte_class<Test>> {
  using attribute_type = char;
  static bool const has_attribute = true;
  template <class AnyContext>
  bool test(char c, AnyContext const&) const {
    return Test(c);
  }
};
inline constexpr byte_class<words::begins_name> name_begin{};
inline constexpr byte_class<words::continues_name> name_byte{};
inline constexpr byte_class<words::is_digit> digit{};

/// A whole word.
inline auto word(char const* spelling) { return x3::lexeme[x3::lit(spelling) >> !name_byte]; }

/// A word that begins a declaration: what follows cannot continue an expression, so `input x` declares and `input*x = 1` is an
/// equation.
inline auto keyword(char const* spelling) {
  return word(spelling) >> &(name_begin | digit | '"' | end_of_statement) >> !(word("and") | word("or"));
}

}  // namespace sysid::grammar
