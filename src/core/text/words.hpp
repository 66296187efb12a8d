// Lists, numbers of things and blanks: the small turns of phrase that messages share.
#pragma once
#include <concepts>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

/// "m", "m and c", "m, c and k"; `last` stands before the last name.
std::string listed(std::vector<std::string> const& names, std::string_view last = "and");
/// "`m`", "`m` and `c`", "`m`, `c` and `k`".
std::string quoted(std::vector<std::string> const& names, std::string_view last = "and");
/// The first `most` names with commas between them, and how many there are beyond: "m, c and 3 more".
std::string first_listed(std::vector<std::string> const& names, std::size_t most);

/// "row" of 1, "rows" of any other number.
template <std::integral Count>
std::string plural(std::string_view noun, Count count) {
  return std::string(noun) + (count == 1 ? "" : "s");
}
/// "1 row", "2 rows".
template <std::integral Count>
std::string counted(Count count, std::string_view noun) {
  return std::to_string(count) + " " + plural(noun, count);
}

/// Capitals of ASCII as small letters; all else stays.
constexpr char in_small_letters(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }
std::string in_small_letters(std::string_view text);

/// Without the blanks at both ends. blanks: which characters count as such.
std::string_view trimmed(std::string_view text, std::string_view blanks = " \t\r\n");

}  // namespace sysid
