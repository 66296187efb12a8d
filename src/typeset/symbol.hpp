// Names of the language as symbols of a formula: `k3` is k with the index 3, `omega_n` a Greek letter with the index n.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

/// A letter or a word, and its indices from left to right.
struct Symbol {
  std::string base;
  std::vector<std::string> indices;
};

/// Digits at the end of a letter and what follows an underscore are indices; of `spring.k3`, so is `spring`. A name of several
/// letters, `Cd`, stays whole: nobody but its user knows whether it is one symbol or two.
Symbol symbol(std::string_view name);

/// A Greek letter: the name it is typed by (`alpha`, or itself), the letter, and LaTeX's command ("" where a Latin letter serves).
struct GreekLetter {
  std::string_view name, letter, command;
};
/// By its name or by the letter; nothing for other text.
GreekLetter const* greek_letter(std::string_view text);

/// Number of characters of UTF-8.
std::size_t letters(std::string_view text);

}  // namespace sysid
