// Every message of the syntax stage, one named constructor per mistake; the wording is in errors.cpp. Help for constructs of other
// languages is in hints*.cpp.
#pragma once
#include <span>
#include <string>
#include <string_view>

#include "core/text/diagnostic.hpp"
#include "grammar/message/scan.hpp"

namespace sysid::grammar::errors {

/// E1101: `wanted` and `found` are noun phrases.
Diagnostic expected(Span where, std::string_view wanted, std::string_view found, std::string help = "");
/// E1101: `log_uniform(1; 10)`.
Diagnostic semicolon_in_brackets(Span where);
/// E1101: `with mh(samples = 100) seed = 1`, `normal(y sd = 1)`.
Diagnostic comma_missing(Token const& before, Token const& behind);
/// E1101. behind: the name of the second one.
Diagnostic two_tasks_on_a_line(Token const& behind);
/// E1102: a bracket never closed; `noticed` is where it had to be closed at the latest.
Diagnostic unclosed(Token const& opener, Span noticed);
/// Help where a block stands inside another one.
std::string no_block_inside(Token const& block);
/// E1103
Diagnostic unclosed_text(Span text);
/// E1104: `(a]`.
Diagnostic mismatched(Token const& opener, Token const& closer);
/// E1105: `2 y`; left and right are the tokens on both sides of the gap.
/// instead: what may be meant in place of a product, empty where only that can be.
Diagnostic no_operator_between(Token const& left, Token const& right, std::string_view instead = {});
/// E1106: `a < b < c`.
Diagnostic chained_comparison(Token const& first, Token const& second);
/// E1107: `1.` and `.5`; `repaired` is how it is written.
Diagnostic dot_without_digits(Span number, std::string_view written, std::string_view repaired);
/// Also one behind an exponent.
Diagnostic second_dot(Span number, std::string_view written);
/// E1129: `1d-3`; digits: `1`, exponent: `d-3`.
Diagnostic fortran_exponent(Span number, std::string_view digits, std::string_view exponent);
/// E1108
Diagnostic number_out_of_range(Span number, std::string_view text);
/// E1109: `paramter m ~ ...` in a model, `fiel "a.csv"` in a data block. place: "a model".
Diagnostic unknown_statement(Token const& word, std::string_view place, std::span<std::string_view const> known);
/// E1109: `equation m*y'' = x`.
Diagnostic equation_with_keyword(Token const& word);
/// Help about a word that names a setting of `read`, in this or another program; empty for other words.
std::string setting_of_reading(std::string_view word);
/// Help about a word in a data block that begins a statement of a model; with_tilde: its line has a `~`. Empty for other words.
std::string place_of_statement(std::string_view word, bool with_tilde);
/// Help about a word that other languages compute or show results with; empty for other words.
std::string place_of_output(std::string_view word);
/// E1110: neither an item nor a task begins so.
Diagnostic unknown_item(Token const& word);
/// E1111: `posterior = fitt duffing`.
Diagnostic unknown_verb(Token const& word);
/// E1112: `m*y'' == x`.
Diagnostic double_equals(Span where);
/// E1113: `parameter m log_uniform(1, 2)`; `where` is what stands where `~` had to stand.
/// repaired: the statement with it, empty where that is not known.
Diagnostic tilde_missing(Span where, std::string_view keyword, std::string_view repaired);
/// E1114: `m ~ normal(0, 1)` without its keyword.
Diagnostic tilde_without_keyword(Span where);
/// E1115
/// begin: of its first line; kind: as `other_kind` has it.
Diagnostic other_file(Span begin, std::string const& name, std::string_view kind);
Diagnostic stray_byte(Span where, unsigned char byte);
/// E1115: `:`, a command of LaTeX, or braces inside a statement; `help` says what is written in their place.
Diagnostic no_meaning(Span where, std::string_view found, std::string help);
/// E1116: `×` where `*` is meant.
Diagnostic look_alike(Span where, std::string_view found, std::string_view meant);
/// E1117: `**`, `:=`, `&&`: operators of other languages.
Diagnostic foreign_operator(Span where, std::string_view found, std::string_view help);
/// E1117: `k <- 3`.
Diagnostic left_arrow(Span where);
/// E1118: `[` where no unit may stand.
Diagnostic bracket_out_of_place(Span where);
/// E1118: `[1, 2]` where a value may stand; prior: as the value of a parameter, which may mean a range.
Diagnostic list_in_brackets(Span where, std::string help);
/// E1118: `normal(0, sd = 1) [0, 1]`.
Diagnostic bounds_in_brackets(Span where);
/// E1118: `parameter m [kg] in [0.1, 10]`.
Diagnostic range_in_brackets(Span where);
/// E1119: `if` as a name.
Diagnostic reserved_word(Token const& word);
/// E1120: a statement that begins with + or -.
Diagnostic begins_with_sign(Token const& sign);
/// E1121: `y '`.
/// number: the one that primes group, `1'000`, as it is written here; empty: there is none.
Diagnostic prime_apart(Span where, std::string_view number);
/// E1122
Diagnostic nesting_too_deep(Span where, int most);
/// E1123
Diagnostic statement_too_long(Span where, int most);
Diagnostic text_too_large(Span where, std::size_t most);
Diagnostic word_too_long(Span where, std::ptrdiff_t most);
/// E1124: `"\q"`.
Diagnostic unknown_escape(Span where, std::string_view escape);
/// E1125: a line that ends in an operator, and a declaration on the next.
Diagnostic statement_incomplete(Token const& last, Token const& next);

}  // namespace sysid::grammar::errors
